// Tools: the table, lengths (G43 to G43.2), M61, diameters for cutter compensation, parameters.
//
// What LinuxCNC 2.9 does was seen by running its rs274 (rs274_tools_test.cpp compares more).
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "tests/program/refusals.hpp"
#include "tests/program/rig.hpp"

namespace lamplock::program::tools_test {
namespace {

using test::at;
using test::expect_rows;
using test::mm;
using test::Refusal;
using test::Rig;

TEST(Tools, LengthsOfTheTable) {
  expect_rows({
      {"G10 L1 P1 Z5 R3|T1 M6|G43|Z0", "rapid to 0 0 5"},
      {"G10 L1 P1 Z5|G43 H1|Z0", "rapid to 0 0 5"},
      {"G10 L1 P1 Z5|G0 G43 H1 Z2", "rapid to 0 0 7"},
      {"G10 L1 P1 Z5|G43 Z2 H1 G1 F60", "feed 60 to 0 0 7"},
      {"G10 L1 P1 Z5|G43 H1|G49|Z0", "rapid to 0 0 0"},
      {"G10 L1 P1 Z5|G43 H1|G43 H0|Z0", "rapid to 0 0 0"},
      {"G10 L1 P1 Z5|G10 L1 P2 Z7.5|G43 H2|G43.2 H1|Z0", "rapid to 0 0 12.5"},
      {"G10 L1 P1 Z5|G43.2 H1|G43.2 H1|Z0", "rapid to 0 0 10"},
      {"G10 L1 P1 Z5|G43.1 Z1|G43.2 H1|Z0", "rapid to 0 0 6"},
      {"G10 L1 P1 Z5|G43 H1|G43.1 Z1|Z0", "rapid to 0 0 1"},
      // In force until the next G43.
      {"G10 L1 P1 Z5|G43 H1|G10 L1 P1 Z9|Z0", "rapid to 0 0 5"},
      {"G10 L1 P1 Z5|G43 H1|G10 L1 P1 Z9|G43 H1|Z0", "rapid to 0 0 9"},
      {"G20 G10 L1 P1 Z-1|G43 H1 Z0", "rapid to 0 0 -25.4"},
      // A tool that was chosen is in the spindle after M6.
      {"G10 L1 P1 Z5|G10 L1 P2 Z7|T1 M6|T2|G43 Z0", "rapid to 0 0 5"},
      {"G10 L1 P1 Z5|G10 L1 P2 Z7|T1 M6|M61 Q2|G43 Z0", "rapid to 0 0 7"},
      {"G43 Z1", "rapid to 0 0 1"},
  });
}

TEST(Tools, TouchOff) {
  expect_rows({
      {"Z30|G10 L10 P1 Z2|G43 H1|Z0", "rapid to 0 0 28"},
      {"Z30|G10 L10 P1 Z2|G43 H1|Z2", "rapid to 0 0 30"},
      // The length in force does not count.
      {"Z30|G10 L10 P1 Z2|G43 H1|G53 Z30|G10 L10 P1 Z4|G43 H1|G53 Z0|Z4", "rapid to 0 0 30"},
      {"G10 L2 P9 Z7|G10 L2 P1 Z3|G92 Z9|G53 Z30|G10 L11 P1 Z2|G92.1|G43 H1|G59.3|Z2",
       "rapid to 0 0 30"},
      {"G10 L10 P1 R2|M61 Q1|X#5410", "rapid to 4 0 0"},
  });
}

TEST(Tools, Parameters) {
  expect_rows({
      {"G10 L1 P1 Z5 R3|T1|X#5400 Y#<_current_tool> Z#<_selected_tool>", "rapid to 0 0 1"},
      {"G10 L1 P1 Z5 R3|T1 M6|X#5400 Y#<_current_tool> Z#5403", "rapid to 1 1 0"},
      {"G10 L1 P1 Z5 R3|T1 M6|G43|X#5400 Y#5410 Z#5403", "rapid to 1 6 10"},
      {"X#5410", "rapid to 0 0 0"},
      {"#1=3|G10 L1 P#1 Z[#1+1]|G43 H[#1] Z0", "rapid to 0 0 4"},
  });
}

TEST(Tools, Diameters) {
  expect_rows({
      {"G10 L1 P2 R1|G41 D2|G1 F60 X10|Y10", "feed 60 to 9 1 0"},
      {"G10 L1 P2 R1|T2 M6|G41|G1 F60 X10|Y10", "feed 60 to 9 1 0"},
      {"G10 L1 P2 R1|T2 M6|G42|G1 F60 X10|Y-10", "feed 60 to 9 -1 0"},
  });
}

TEST(Tools, Refusals) {
  constexpr Refusal rows[] = {
      {"G43 H1", GcodeError::unknown_tool, 5},
      {"G43 H256", GcodeError::tool_too_large, 5},
      {"G43 H1.5", GcodeError::not_integer, 5},
      {"G43.2", GcodeError::value_missing, 1},
      {"G43.2 H3", GcodeError::unknown_tool, 7},
      {"G43.2 H0 Z1", GcodeError::words_unused, 10},
      {"G43.1 X1", GcodeError::tool_length_axis, 7},
      {"G41 D2", GcodeError::unknown_tool, 5},
      {"G41 D256", GcodeError::tool_too_large, 5},
      {"G41", GcodeError::no_diameter, 1},
      {"G42 D0", GcodeError::no_diameter, 5},
      {"G41.1", GcodeError::value_missing, 1},
      {"G10 L1 P1", GcodeError::no_axis_words, 1},
      {"G10 L1 Z1", GcodeError::value_missing, 1},
      {"G10 L1 P0 Z1", GcodeError::not_positive, 8},
      {"G10 L1 P256 Z1", GcodeError::tool_too_large, 8},
      {"G10 L1 P1 X1", GcodeError::tool_length_axis, 11},
      {"G10 L1 P1 R-1", GcodeError::negative_value, 11},
      {"G10 L1 P1 R500.1", GcodeError::out_of_range, 11},
      {"G10 L1 P1 Z2000.1", GcodeError::out_of_range, 11},
      {"G10 L1 P1 Z1 Q1", GcodeError::words_unused, 14},
      {"G10 L12 P1 Z1", GcodeError::unsupported, 5},
  };
  test::expect_refused<Rig>(rows);
}

TEST(Tools, TheTableNamesTheToolsThatTMayChoose) {
  Rig rig;
  EXPECT_EQ(rig.run("T9 M6"), "tool");  // as in grbl
  EXPECT_EQ(rig.run("G10 L1 P1 Z5"), "");
  EXPECT_EQ(rig.run("T9"), "95@1");
  EXPECT_EQ(rig.run("M61 Q9"), "95@5");
  EXPECT_EQ(rig.run("T1 M6"), "tool");
  EXPECT_EQ(rig.run("T0 M6"), "tool");
  EXPECT_EQ(rig.run("M61 Q1"), "");
  EXPECT_EQ(rig.run("G41"), "91@1");  // without a diameter
  EXPECT_EQ(rig.run("G41 D1"), "91@5");
}

TEST(Tools, HAndDWithoutTheirCommandsHaveNoEffect) {
  Rig rig;
  EXPECT_EQ(rig.run("G10 L1 P1 Z5 R1"), "");
  EXPECT_EQ(rig.run("G43 H1 G41 D1"), "");
  EXPECT_FALSE(rig.interpreter.has_ignored());
  EXPECT_EQ(rig.run("G40"), "");
  EXPECT_EQ(rig.run("X1 H1 D1"), "rapid to 1 0 0");
  EXPECT_TRUE(rig.interpreter.has_ignored());
}

TEST(Tools, OverResetsAndRestoredStates) {
  Rig rig;
  rig.run("G10 L1 P1 Z5");
  rig.run("G10 L1 P2 Z7");
  rig.run("T1 M6");
  rig.run("M70");
  rig.run("T2 M6");
  rig.run("M72");
  EXPECT_EQ(rig.interpreter.modal().loaded_tool, 2);
  rig.run("G43");
  rig.interpreter.reset();
  EXPECT_EQ(rig.interpreter.work_offset_e7(), at(0, 0, 7));
  Tool tool;
  EXPECT_TRUE(rig.parameters.tools.find(1, tool));
  EXPECT_EQ(tool.length_e7, mm(5));
}

TEST(Tools, FullTable) {
  Rig rig;
  for (std::size_t i = 1; i <= ToolTable::capacity; ++i)
    EXPECT_EQ(rig.run(fmt::format("G10 L1 P{} Z{}", 10 * i, i)), "");
  EXPECT_EQ(rig.run("G10 L1 P1 Z1"), "96@8");
  EXPECT_EQ(rig.run("G10 L1 P10 Z99"), "");
  EXPECT_EQ(rig.run("G43 H10 Z0"), "rapid to 0 0 99");
  EXPECT_EQ(rig.run("T1"), "95@1");
}

/// Random entries equal those of a map; a diameter D of the table acts as G41.1 D.
RC_GTEST_PROP(Tools, EntriesAreKept, ()) {
  Rig rig;
  std::map<int, std::pair<int, int>> wanted;  // 10^-4 mm
  const int lines = *rc::gen::inRange(1, 60);
  for (int i = 0; i < lines; ++i) {
    const int number = *rc::gen::inRange(1, 40);
    const int length = *rc::gen::inRange(-2'000'000, 2'000'000);
    const int radius = *rc::gen::inRange(0, 400'000);
    const bool has_length = *rc::gen::arbitrary<bool>(), has_radius = *rc::gen::arbitrary<bool>();
    std::string line = fmt::format("G10 L1 P{}", number);
    if (has_length) line += fmt::format(" Z{:.4f}", length / 1e4);
    if (has_radius) line += fmt::format(" R{:.4f}", radius / 1e4);
    const bool fits = wanted.size() < ToolTable::capacity || wanted.contains(number);
    const bool good = fits && (has_length || has_radius);
    RC_ASSERT(rig.run(line).empty() == good);
    if (!good) continue;
    if (has_length) wanted[number].first = length;
    if (has_radius) wanted[number].second = radius;
  }
  for (const auto& [number, values] : wanted) {
    Tool tool;
    RC_ASSERT(rig.parameters.tools.find(static_cast<std::uint32_t>(number), tool));
    RC_ASSERT(tool.length_e7 == values.first * std::int64_t{1000});
    RC_ASSERT(tool.diameter_e7 == values.second * std::int64_t{2000});
  }
}

RC_GTEST_PROP(Tools, DiametersOfTheTableActAsDWords, ()) {
  const int radius = *rc::gen::inRange(1, 20'000);
  const bool left = *rc::gen::arbitrary<bool>();
  Rig table, word;
  table.run(fmt::format("G10 L1 P7 R{:.4f}", radius / 1e4));
  table.run(left ? "G41 D7" : "G42 D7");
  word.run(fmt::format("G4{}.1 D{:.4f}", left ? 1 : 2, 2 * radius / 1e4));
  for (const char* line : {"G1 F60 X10", "Y10", "G2 X20 Y20 R10", "X30", "Y0", "G40", "X0 Y0"})
    RC_ASSERT(table.run(line) == word.run(line));
}

}  // namespace
}  // namespace lamplock::program::tools_test
