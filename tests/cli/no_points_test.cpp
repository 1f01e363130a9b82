// Objects that give no points: the message names the cause, and each remedy in it gives points.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

/// A plate from the origin to a corner: 12 triangles, 2 without a height.
std::string plate_stl(double x, double y, double z) {
  const double size[3] = {x, y, z};
  std::string text = "solid plate\n";
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int half = 0; half < 2; ++half) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (int corner = 0; corner < 3; ++corner) {
          const int bits = half == 0 ? corner : 3 - corner;
          double at[3] = {};
          at[axis] = side * size[axis];
          at[(axis + 1) % 3] = (bits & 1) * size[(axis + 1) % 3];
          at[(axis + 2) % 3] = (bits >> 1) * size[(axis + 2) % 3];
          text += fmt::format("vertex {} {} {}\n", at[0], at[1], at[2]);
        }
        text += "endloop\nendfacet\n";
      }
    }
  }
  return text + "endsolid plate\n";
}

/// A grey picture, BMP of 24 bits.
std::string grey_bmp(int grey) {
  constexpr int side = 16, head = 54;
  std::string bytes = "BM";
  const auto put = [&bytes](int value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  };
  put(head + 3 * side * side, 4), put(0, 4), put(head, 4), put(40, 4), put(side, 4), put(side, 4);
  put(1, 2), put(24, 2), put(0, 4), put(3 * side * side, 4), put(2835, 4), put(2835, 4), put(0, 4),
      put(0, 4);
  return bytes + std::string(std::size_t{3} * side * side, static_cast<char>(grey));
}

/// The options that a remedy offers: "use --axis x, or --method blue-noise" has two. "leave out
/// --invert" has the option with a minus before it.
std::vector<std::vector<std::string>> remedies_of(const std::string& error) {
  std::vector<std::vector<std::string>> all;
  const std::string remedy = error.substr(error.rfind(';'));
  const std::regex option("(leave out )?(--[a-z-]+)( [a-z0-9.][a-z0-9.-]*)?");
  for (std::sregex_iterator at(remedy.begin(), remedy.end(), option), end; at != end; ++at) {
    const std::string value = (*at)[3].str(), name = (*at)[2].str();
    if (name == "--spacing" || name == "--size") continue;  // by how much is not said
    const bool is_removed = (*at)[1].matched;
    std::vector<std::string> words{(is_removed ? "-" : "") + name};
    if (!value.empty()) words.push_back(value.substr(1));
    all.push_back(words);
  }
  return all;
}

struct Case {
  std::string file;
  std::vector<std::string> options;
  std::string cause;
  std::size_t remedies;
};

TEST(NoPoints, name_their_cause_and_remedies_that_work) {
  const Folder folder;
  const std::string flat = folder.write("flat.stl", plate_stl(10, 6, 0)),
                    cube = folder.write("cube.stl", plate_stl(10, 10, 10)),
                    thin = folder.write("thin.stl", plate_stl(10, 6, 0.02)),
                    wall = folder.write("wall.stl", plate_stl(0, 6, 10)),
                    white = folder.write("white.bmp", grey_bmp(255)),
                    black = folder.write("black.bmp", grey_bmp(0)),
                    grey = folder.write("grey.bmp", grey_bmp(200)),
                    dark = folder.write("dark.bmp", grey_bmp(50));
  const std::vector<Case> cases{
      {flat, {"--method", "slice"}, "is 0 mm high along z", 2},
      {wall, {"--method", "slice", "--axis", "x"}, "is 0 mm high along x", 2},
      {flat, {"--method", "slice", "--turn", "0,0,30"}, "high across the turned planes", 1},
      {thin, {"--method", "slice"}, "half a layer", 2},
      {cube, {"--method", "slice", "--first", "20"}, "20 mm above its lowest point", 1},
      {cube, {"--method", "slice", "--first", "10.5"}, "10.5 mm above", 1},
      {flat,
       {"--method", "rays", "--direction", "x"},
       "along the rays, which have the direction x",
       2},
      {wall, {"--method", "rays"}, "along the rays, which have the direction z", 2},
      {cube, {"--method", "faces", "--smallest", "50"}, "--smallest 50", 2},
      {flat, {"--method", "solid"}, "inside", 1},
      {white, {}, "it is white", 1},
      {white, {"--tone"}, "it is white", 2},
      {black, {"--tone", "--invert"}, "it is black", 2},
      {black, {"--invert"}, "it is black", 1},
      {grey, {}, "darkest grey is 200", 3},
      {dark, {"--invert"}, "lightest grey is 50", 3}};
  for (const Case& one : cases) {
    std::vector<std::string> words{"points", one.file, "-o", folder / "p.xyz", "--spacing", "0.4"};
    words.insert(words.end(), one.options.begin(), one.options.end());
    const Finished refused = run(words);
    EXPECT_EQ(refused.status, 2) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr(one.cause));
    std::size_t followed = 0;
    for (const auto& remedy : remedies_of(refused.err)) {
      std::vector<std::string> again = words;
      // An option that is given twice is refused: the remedy replaces it.
      const bool is_removed = remedy[0].starts_with("---");
      const std::string name = is_removed ? remedy[0].substr(1) : remedy[0];
      const auto given = std::find(again.begin(), again.end(), name);
      if (given != again.end()) again.erase(given, given + (remedy.size() > 1 ? 2 : 1));
      if (!is_removed) again.insert(again.end(), remedy.begin(), remedy.end());
      const Finished made = run(again);
      EXPECT_EQ(made.status, 0) << refused.err << made.err;
      ++followed;
    }
    EXPECT_EQ(followed, one.remedies) << refused.err;
  }
}

}  // namespace
}  // namespace lamplock::cli::test
