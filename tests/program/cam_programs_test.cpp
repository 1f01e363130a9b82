// Programs in the styles of five post-processors (tests/data/cam): none of their lines is refused,
// and the same part is cut alike in every style.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <vector>

#include "tests/paths.hpp"
#include "tests/program/rig.hpp"

namespace lamplock::program::cam_programs_test {
namespace {

using test::Rig;

constexpr std::size_t styles = 5, parts = 12;

/// What a program cuts: its moves at a feed. The height from which a tool goes down is a matter of
/// the style.
struct Cut {
  double length_mm = 0;  ///< in XY
  std::int64_t lowest_e7 = 0;
  std::size_t tool_changes = 0;
  bool ended = false;
};

double distance_mm(const Place& a, const Place& b) {
  return std::hypot(static_cast<double>(a[0] - b[0]), static_cast<double>(a[1] - b[1])) / one_e7;
}

/// Runs a program on a machine whose table has its tools, and which has been homed at Z 60.
Cut run(const std::filesystem::path& path) {
  Rig rig;
  rig.options.axes = 3;
  rig.options.arc_tolerance_e7 = 1000;
  for (const char* line : {"G10 L1 P1 Z0.4 R3", "G10 L1 P2 Z0.525 R1.5", "G10 L1 P3 Z0.1 R0.5",
                           "G0 Z60", "G28.1", "G30.1"})
    EXPECT_EQ(rig.interpreter.run(line).error, GcodeError::none) << rig.take().size();
  rig.take();
  Cut cut;
  std::ifstream file(path);
  Place here = rig.machine();
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const Fault fault = rig.interpreter.run(line);
    EXPECT_FALSE(fault) << path.filename() << ":" << number << ": " << line << " "
                        << test::text_of(fault);
    for (const Action& action : rig.take()) {
      cut.tool_changes += action.kind == ActionKind::tool_change ? 1 : 0;
      cut.ended = cut.ended || action.kind == ActionKind::program_end;
      if (action.kind != ActionKind::move) continue;
      if (!action.rapid) {
        cut.length_mm += distance_mm(here, action.target_e7);
        cut.lowest_e7 = std::min(cut.lowest_e7, action.target_e7[2]);
      }
      here = action.target_e7;
    }
  }
  EXPECT_FALSE(rig.interpreter.holds_move()) << path.filename();
  return cut;
}

TEST(CamPrograms, NoLineIsRefusedAndPartsAreCutAlike) {
  std::map<std::string, std::vector<Cut>> cuts;
  std::set<std::string> seen;
  for (const auto& entry :
       std::filesystem::directory_iterator(lamplock::test::in_repository("tests/data/cam"))) {
    if (entry.path().extension() != ".nc") continue;
    const std::string name = entry.path().stem().string();
    const std::size_t line = name.find('_');
    ASSERT_NE(line, std::string::npos) << name;
    seen.insert(name.substr(0, line));
    cuts[name.substr(line + 1)].push_back(run(entry.path()));
  }
  EXPECT_EQ(seen.size(), styles);
  EXPECT_EQ(cuts.size(), parts);
  for (const auto& [part, all] : cuts) {
    ASSERT_EQ(all.size(), styles) << part;
    for (const Cut& cut : all) {
      EXPECT_TRUE(cut.ended) << part;
      EXPECT_EQ(cut.tool_changes, part == "tools" ? 3u : 1u) << part;
      EXPECT_NEAR(cut.length_mm, all.front().length_mm, 0.01) << part;
      EXPECT_EQ(cut.lowest_e7, all.front().lowest_e7) << part;
      EXPECT_TRUE(cut.length_mm > 20 || cut.lowest_e7 < 0) << part;
    }
  }
}

}  // namespace
}  // namespace lamplock::program::cam_programs_test
