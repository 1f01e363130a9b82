// Questions about models of an unlikely size or position: on standard error, once, and none about
// what the user has decided.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A box from the origin to a corner, as text.
std::string box_stl(double x, double y, double z) {
  std::string text = "solid box\n";
  const double size[3] = {x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {0.0, 1.0})
      for (const auto& triangle : {std::array{0, 1, 3}, std::array{0, 3, 2}}) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int corner : triangle) {
          double at[3] = {};
          at[axis] = side * size[axis];
          at[(axis + 1) % 3] = (corner & 1) * size[(axis + 1) % 3];
          at[(axis + 2) % 3] = (corner >> 1) * size[(axis + 2) % 3];
          text += fmt::format("vertex {} {} {}\n", at[0], at[1], at[2]);
        }
        text += "endloop\nendfacet\n";
      }
  return text + "endsolid box\n";
}

TEST(SizeHints, asks_about_unlikely_sizes_and_positions) {
  const Folder folder;
  const auto hints = [&](double x, double y, double z, const std::vector<std::string>& more,
                         const char* spacing = "0.5") {
    std::vector<std::string> all{"points",    folder.write("m.stl", box_stl(x, y, z)),
                                 "-o",        folder / "p.xyz",
                                 "--spacing", spacing};
    all.insert(all.end(), more.begin(), more.end());
    const Finished made = run(all);
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_THAT(made.out, Not(HasSubstr("in mm?")));
    return made.err;
  };
  const auto size = HasSubstr("is the file in mm? --size 40"), flat = HasSubstr("--up y");
  EXPECT_THAT(hints(4.9, 4, 4, {}, "0.1"), AllOf(size, Not(flat)));
  EXPECT_EQ(lines(hints(0.04, 0.04, 0.04, {})).size(), 1u);
  EXPECT_THAT(hints(6, 6, 6, {}, "2"), size) << "few points";
  EXPECT_EQ(hints(20, 20, 20, {}), "");
  EXPECT_EQ(hints(4, 4, 4, {"--size", "4"}), "") << "the user has decided";
  EXPECT_THAT(hints(20, 40, 10, {}), AllOf(flat, Not(size)));
  EXPECT_EQ(hints(20, 40, 10, {"--up", "y"}), "");
  EXPECT_EQ(hints(20, 40, 10, {"--transform", "rotate x 90"}), "");
  EXPECT_EQ(hints(10, 40, 20, {}), "") << "higher than wide";
}

}  // namespace
}  // namespace lamplock::cli::test
