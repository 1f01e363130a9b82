// Offsets: coordinate systems, G92, tool length, homes, machine coordinates; exactness.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <string>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::interpreter_offsets_test {
namespace {

using lamplock::test::scaled;
using test::at;
using test::expect_rows;
using test::mm;
using test::Rig;

TEST(Offsets, CoordinateSystems) {
  expect_rows({
      {"G10 L2 P1 X10 Y20|X0 Y0", "rapid to 10 20 0"},
      {"G10 L2 P2 X10|X1", "rapid to 1 0 0"},
      {"G10 L2 P2 X10|G55 X1", "rapid to 11 0 0"},
      {"G10 L2 P8 X10|G54.1 P2 X1", "rapid to 11 0 0"},
      {"G10 L2 P2 X10|G55|G10 L2 P0 X20|X1", "rapid to 21 0 0"},
      {"G10 L2 P2 X10|G55|X1|G54 X1", "rapid to 1 0 0"},
      {"G10 L2 P9 Z1|G59.3 Z1", "rapid to 0 0 2"},
      {"G10 L2 P8 Z1|G59.2 Z1", "rapid to 0 0 2"},
      {"G10 L2 P7 Z1|G59.1 Z1", "rapid to 0 0 2"},
      {"G10 L2 P6 Z1|G59 Z1", "rapid to 0 0 2"},
      {"G10 L2 P3 Z1|G56 Z1", "rapid to 0 0 2"},
      {"G10 L2 P1 A2|A1", "rapid to 0 0 0 3"},
      {"X5|G10 L20 P1 X1|X2", "rapid to 6 0 0"},
      {"X5|G10 L20 P2 X1|G55 X0", "rapid to 4 0 0"},
      {"X5|G92 X1|G10 L20 P1 X0|X0", "rapid to 5 0 0"},
      {"X5|G92 X1|G10 L20 P2 X0|G55 X0", "rapid to 5 0 0"},
      {"G10 L2 P1 X10|G10 L2 P1 Y1|X0 Y0", "rapid to 10 1 0"},
      {"G20 G10 L2 P1 X1|G21 X0", "rapid to 25.4 0 0"},
      {"G91 G10 L2 P1 X10|G90 X0", "rapid to 10 0 0"},  // not relative
      {"G10 L2 P1 X10|G91 X1", "rapid to 1 0 0"},
  });
}

TEST(Offsets, Shift) {
  expect_rows({
      {"X5 Y5|G92 X0|X1", "rapid to 6 5 0"},
      {"X5 Y5|G92 X0|Y1", "rapid to 5 1 0"},
      {"X5|G92 X0|G92 Y1|X1 Y1", "rapid to 6 0 0"},
      {"X5|G92 X0|G92.1|X1", "rapid to 1 0 0"},
      {"X5|G92 X0|G92.1|G92.3|X1", "rapid to 1 0 0"},
      {"X5|G92 X0|G92.2|X1", "rapid to 1 0 0"},
      {"X5|G92 X0|G92.2|G92.3|X1", "rapid to 6 0 0"},
      {"X5|G92 X0|G92.2|G92 Y3|X1", "rapid to 1 0 0"},
      {"X5|G92 X0|G92.1 X1", "rapid to 1 0 0"},  // G92.1 and a move
      {"G10 L2 P1 X10|X0|G92 X5|X5", "rapid to 10 0 0"},
      {"G10 L2 P1 X10|X0|G92 X5|G55 X5", "rapid to 0 0 0"},
      {"X5|G92 X0|M2|G90 G0 X1", "rapid to 6 0 0"},
      {"X5|G92 X0|G91 X1", "rapid to 6 0 0"},
      {"G91 X5|G92 X1|G90 X0", "rapid to 4 0 0"},
  });
}

TEST(Offsets, ToolLength) {
  expect_rows({
      {"G43.1 Z2|Z1 X1", "rapid to 1 0 3"},
      {"G43.1 Z2|G49|Z1", "rapid to 0 0 1"},
      {"G43.1 Z2|G92 Z0|Z0", "rapid to 0 0 0"},
      {"G43.1 Z2|G43.1 Z3|Z0", "rapid to 0 0 3"},
      {"G20 G43.1 Z-1|Z0", "rapid to 0 0 -25.4"},
      {"G43.1 Z2|G10 L20 P1 Z0|Z0", "rapid to 0 0 0"},
  });
}

TEST(Offsets, Homes) {
  expect_rows({
      {"G28", "rapid to 0 0 0"},
      {"X1 Y2|G28.1|X9 Y9|G28", "rapid to 1 2 0"},
      {"X1 Y2|G30.1|X9 Y9|G30", "rapid to 1 2 0"},
      {"X1 Y2|G30.1|X9 Y9|G28", "rapid to 0 0 0"},
      {"X1 Y2|G28.1|X9 Y9|G28 X5", "rapid to 5 9 0 on the way; rapid to 1 9 0"},
      {"X1 Y2|G28.1|X9 Y9|G91 G28 Z1", "rapid to 9 9 1 on the way; rapid to 9 9 0"},
      {"X9|G91 G28 X0 Y0 Z0", "rapid to 9 0 0 on the way; rapid to 0 0 0"},
      {"G10 L2 P1 X10|G28 X1", "rapid to 11 0 0 on the way; rapid to 0 0 0"},
      {"X1|G28.1 X5", "rapid to 5 0 0"},  // G28.1 has no axis words: X5 is a move
      {"X1|G28.1 X5|G28", "rapid to 1 0 0"},
      {"X9|G28|G91 X1", "rapid to 1 0 0"},
      {"G80|X1 G28", "rapid to 1 0 0 on the way; rapid to 0 0 0"},
  });
}

TEST(Offsets, MachineCoordinates) {
  expect_rows({
      {"G10 L2 P1 X10|G53 X1", "rapid to 1 0 0"},
      {"G10 L2 P1 X10|G53 X1|X1", "rapid to 11 0 0"},
      {"G91 X5|G53 X1", "rapid to 1 0 0"},
      {"G53 G1 F60 X1", "feed 60 to 1 0 0"},
      {"G20 G53 X1", "rapid to 25.4 0 0"},
      {"G53", ""},
      {"G43.1 Z5|G53 Z1", "rapid to 0 0 1"},
  });
}

TEST(Offsets, StoredValuesAreReportedOnce) {
  Rig rig;
  rig.run("X1 Y2");
  EXPECT_EQ(rig.parameters.changed, 0);
  rig.run("G10 L2 P3 X7");
  EXPECT_EQ(rig.parameters.changed, 1u << 2);
  EXPECT_EQ(rig.parameters.systems_e7[2], at(7, 0));
  rig.run("G28.1");
  EXPECT_EQ(rig.parameters.home_g28_e7, at(1, 2));
  rig.run("G30.1 G43.1 Z4");
  EXPECT_EQ(rig.parameters.home_g30_e7, at(1, 2));
  EXPECT_EQ(rig.parameters.tool_length_e7, mm(4));
  rig.run("G92 X0");
  EXPECT_EQ(rig.parameters.shift_e7, at(1, 0));
  EXPECT_EQ(rig.parameters.changed, 1u << 2 | 1u << 9 | 1u << 10 | 1u << 11 | 1u << 12);
  EXPECT_EQ(rig.interpreter.work_offset_e7(), at(1, 0, 4));
  rig.run("G56");
  EXPECT_EQ(rig.interpreter.work_offset_e7(), at(8, 0, 4));
  rig.parameters.changed = 0;
  rig.run("G92.2");
  EXPECT_EQ(rig.parameters.changed, 0);
  rig.run("G49");
  EXPECT_EQ(rig.parameters.changed, 1u << 12);
  EXPECT_EQ(rig.parameters.tool_length_e7, 0);
  rig.parameters.changed = 0;
  rig.run("G49");
  EXPECT_EQ(rig.parameters.changed, 0);
  EXPECT_EQ(rig.interpreter.work_offset_e7(), at(7, 0));
}

/// A number of units with the given decimals.
std::string number(std::int64_t units, int decimals) {
  std::string digits = std::to_string(units < 0 ? -units : units);
  while (digits.size() <= static_cast<std::size_t>(decimals)) digits.insert(0, "0");
  digits.insert(digits.size() - static_cast<std::size_t>(decimals), ".");
  return fmt::format("{}{}", units < 0 ? "-" : "", digits);
}

/// Relative moves in millimetres and inches end exactly where absolute ones do.
TEST(Offsets, RelativeProgramsDoNotDrift) {
  std::mt19937_64 random(5);
  for (int run = 0; run < scaled(100); ++run) {
    const bool inches = run % 2 == 0;
    const int decimals = inches ? 6 : 7;
    const std::int64_t unit = inches ? 254 : 1;  // of one in the last decimal, e7
    const std::string code = inches ? "G20" : "G21";
    Rig relative, absolute;
    relative.run(code + "G91");
    absolute.run(code + "G90");
    PerAxis<std::int64_t> sum{};
    for (int i = 0; i < 200; ++i) {
      std::string by, to;
      for (std::size_t axis = 0; axis < 4; ++axis) {
        if (random() % 2 == 0) continue;
        const std::int64_t way = static_cast<std::int64_t>(random() % 20'000'001) - 10'000'000;
        sum[axis] += way;
        by += "XYZA"[axis] + number(way, decimals);
        to += "XYZA"[axis] + number(sum[axis], decimals);
      }
      relative.run(by);
      absolute.run(to);
      ASSERT_EQ(relative.machine(), absolute.machine());
      for (std::size_t axis = 0; axis < 4; ++axis)
        ASSERT_EQ(relative.machine()[axis], sum[axis] * unit);
    }
  }
}

}  // namespace
}  // namespace lamplock::program::interpreter_offsets_test
