// A as a rotary axis ($967): units, feed, the shortest way.
#include "firmware/program/rotary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::rotary_test {
namespace {

using test::Rig;
using test::Row;

constexpr std::uint8_t rotary_a = 1u << 3;

template <std::size_t size>
void expect_rotary_rows(const Row (&rows)[size], bool shortest_way = false) {
  for (const Row& row : rows) {
    Rig rig;
    rig.options.rotary = rotary_a;
    rig.options.shortest_way = shortest_way;
    EXPECT_EQ(rig.run_all(row.lines), row.wanted) << row.lines;
  }
}

TEST(Rotary, DegreesAreNotInches) {
  expect_rotary_rows({
      {"G20 X1 A10", "rapid to 25.4 0 0 10"},
      {"G20 G91 A10|A10", "rapid to 0 0 0 20"},
      {"G20 G10 L2 P1 A10|A5", "rapid to 0 0 0 15"},
      {"G20 A10|G92 A5|A0", "rapid to 0 0 0 5"},
      {"G20 A10|G10 L20 P1 A1|A0", "rapid to 0 0 0 9"},
      {"G20 A10|#1=#5423 #2=#<_a>|G53 A[#1+#2]", "rapid to 0 0 0 20"},
      {"G20 G53 A10", "rapid to 0 0 0 10"},
  });
  test::expect_rows({{"G20 X1 A10", "rapid to 25.4 0 0 254"}});
}

/// F is along X, Y and Z, so the path of all axes is faster: here 5/4 and 5/3 times.
TEST(Rotary, FeedIsThatOfTheLinearAxes) {
  expect_rotary_rows({
      {"G1 F120 X4 A3", "feed 150 to 4 0 0 3"},
      {"G1 F120 X3 A-4", "feed 200 to 3 0 0 -4"},
      {"G1 F120 Y12 Z5 A13", "feed 169.705 to 0 12 5 13"},
      {"G10 L2 P1 R90|G1 F120 X4 A3", "feed 150 to 0 4 0 3"},
      {"G91 G1 F120 X4 A3|X4 A3", "feed 150 to 8 0 0 6"},
      {"G1 F120 X4 A3|X8", "feed 120 to 8 0 0 3"},
      {"G53 G1 F120 X4 A3", "feed 150 to 4 0 0 3"},
      {"G95 S60 G1 F2 X4 A3", "feed 150 to 4 0 0 3"},
      {"G1 F120 A90", "feed 120 to 0 0 0 90"},
      {"G1 F120 X0 A90", "feed 120 to 0 0 0 90"},
      {"G20 G1 F120 A90", "feed 120 to 0 0 0 90"},
      {"G20 G1 F10 X4 A76.2", "feed 317.5 to 101.6 0 0 76.2"},
      {"G0 X4 A3", "rapid to 4 0 0 3"},
      {"G1 F4000000 X0.0000001 A9000", "feed 4294967.295 to 0.0000001 0 0 9000"},
  });
  test::expect_rows({{"G1 F120 X4 A3", "feed 120 to 4 0 0 3"}});
  Rig rig;
  rig.options.rotary = rotary_a;
  EXPECT_EQ(rig.jog("G91 X4 A3 F120"), "feed 150 to 4 0 0 3");
}

TEST(Rotary, InverseTimeIsTheTimeOfTheMove) {
  for (const char* const line : {"G93 G1 F2 X4 A3", "G93 G1 F2 A3"}) {
    Rig rig;
    rig.options.rotary = rotary_a;
    ASSERT_FALSE(rig.interpreter.run(line));
    const std::vector<Action> actions = rig.take();
    ASSERT_EQ(actions.size(), 1u);
    EXPECT_TRUE(actions[0].timed);
    EXPECT_EQ(actions[0].time_us, 30'000'000u);
  }
}

/// Every piece of a helix with A takes the time of its chord.
TEST(Rotary, CurvesKeepTheirFeed) {
  for (const char* const line : {"G2 X20 I10 A720", "G17 G3 X20 Z5 I10 A-31"}) {
    Rig rig;
    rig.options.rotary = rotary_a;
    ASSERT_FALSE(rig.interpreter.run(std::string("F600 ") + line));
    Place from{};
    double minutes = 0, length_mm = 0;
    for (const Action& action : rig.take()) {
      const Place& to = action.target_e7;
      double linear = 0;
      for (std::size_t i = 0; i < 3; ++i)
        linear += std::pow(static_cast<double>(to[i] - from[i]) / one_e7, 2);
      const double turned = static_cast<double>(to[3] - from[3]) / one_e7;
      length_mm += std::sqrt(linear);
      minutes += std::sqrt(linear + turned * turned) / (action.feed_um_min / 1e3);
      from = to;
    }
    EXPECT_NEAR(length_mm / minutes, 600, 0.01) << line;
  }
}

TEST(Rotary, TheShortestWayRound) {
  expect_rotary_rows(
      {
          {"A10|A350", "rapid to 0 0 0 -10"},
          {"A10|A350|A10", "rapid to 0 0 0 10"},
          {"A170|A190|A210|A10", "rapid to 0 0 0 370"},
          {"A180", "rapid to 0 0 0 180"},
          {"A-180", "rapid to 0 0 0 180"},
          {"A725", "rapid to 0 0 0 5"},
          {"A360", "rapid to 0 0 0"},
          {"G91 A350", "rapid to 0 0 0 350"},
          {"G91 A350|G90 A10", "rapid to 0 0 0 370"},
          {"G91 A350|G53 A10", "rapid to 0 0 0 370"},
          {"G10 L2 P1 A100|A350", "rapid to 0 0 0 90"},
          {"G91 A700|G28", "rapid to 0 0 0 720"},
          {"G91 A700|G28 A0", "rapid to 0 0 0 700 on the way; rapid to 0 0 0 720"},
          {"X400|X10", "rapid to 10 0 0"},
          {"G1 F120 X4 A363", "feed 150 to 4 0 0 3"},
      },
      true);
  expect_rotary_rows({{"A10|A350", "rapid to 0 0 0 350"}});
}

TEST(Rotary, TheShortestWayIsHalfATurnAtMost) {
  std::mt19937_64 random(3);
  for (int i = 0; i < lamplock::test::scaled(2000); ++i) {
    const auto place = [&random] {
      return static_cast<std::int64_t>(random() % 200'000'000'001) - 100'000'000'000;
    };
    const std::int64_t from = place(), to = place(), end = shortest_way_e7(from, to);
    ASSERT_EQ((end - to) % (360 * one_e7), 0);
    ASSERT_GT(end - from, -180 * one_e7);
    ASSERT_LE(end - from, 180 * one_e7);
  }
}

TEST(Rotary, HasTheRangeOfAllWords) {
  expect_rotary_rows({{"A10001", "33@1"}, {"G91 A9999|A2", "33@1"}});
  expect_rotary_rows({{"A10001", "33@1"}, {"G91 A9999|A2", "33@1"}, {"G91 A10000|G90 A90", "33@5"}},
                     true);
}

}  // namespace
}  // namespace lamplock::program::rotary_test
