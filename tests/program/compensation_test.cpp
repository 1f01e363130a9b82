// Cutter compensation: lengths of known contours, distances from random ones, what waits, and what
// is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/program/contour_programs.hpp"
#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::compensation_test {
namespace {

using lamplock::test::scaled;
using test::Rig;

struct Travel {
  double feed_mm = 0;
  std::vector<std::array<double, 2>> places{};  ///< of feed moves
};

/// Takes the actions of the last line.
void take(Rig& rig, Travel& travel, std::array<double, 2>& at) {
  for (const Action& action : rig.take()) {
    if (action.kind != ActionKind::move) continue;
    const std::array<double, 2> to{static_cast<double>(action.target_e7[0]) / one_e7,
                                   static_cast<double>(action.target_e7[1]) / one_e7};
    if (!action.rapid) {
      travel.feed_mm += std::hypot(to[0] - at[0], to[1] - at[1]);
      travel.places.push_back(to);
    }
    at = to;
  }
}

double feed_length(const std::vector<std::string>& lines) {
  Rig rig;
  rig.options.arc_tolerance_e7 = 100;
  Travel travel;
  std::array<double, 2> at{};
  for (const std::string& line : lines) {
    EXPECT_EQ(test::text_of(rig.interpreter.run(line)), "0@0") << line;
    take(rig, travel, at);
  }
  return travel.feed_mm;
}

/// The contour begins at X5 Y0 and is reached along its first line.
double contour_length(const std::string& code, std::vector<std::string> contour) {
  contour.insert(contour.begin(), {"G21 G90 F600", "G0 X2 Y0", code, "G0 X5 Y0"});
  contour.insert(contour.end(), {"G40", "G0 X0 Y0", "M2"});
  return feed_length(contour);
}

// Lengths by hand: sides, and for each outer corner an arc of the radius.
TEST(Compensation, LengthsOfKnownContours) {
  const std::vector<std::string> square{"G1 X10", "Y10", "X0", "Y0", "X5"};
  EXPECT_NEAR(contour_length("G42.1 D.5", square), 41.5708, 1e-4);
  EXPECT_NEAR(contour_length("G41.1 D.5", square), 38, 1e-4);
  const std::vector<std::string> l_shape{"G1 X20", "Y10", "X10", "Y20", "X0", "Y0", "X5"};
  EXPECT_NEAR(contour_length("G42.1 D.5", l_shape), 81.4635, 1e-4);
  EXPECT_NEAR(contour_length("G41.1 D.5", l_shape), 77.8927, 1e-4);
  const std::vector<std::string> rounded{"G1 X57",         "G3 X60 Y3 J3", "G1 Y17",
                                         "G3 X57 Y20 I-3", "G1 X3",        "G3 X0 Y17 J-3",
                                         "G1 Y3",          "G3 X3 Y0 I3",  "G1 X5"};
  EXPECT_NEAR(contour_length("G42.1 D0", rounded), 154.8496, 1e-4);
  EXPECT_NEAR(contour_length("G42.1 D.5", rounded), 156.4204, 1e-4);
  EXPECT_NEAR(contour_length("G41.1 D.5", rounded), 153.2788, 1e-4);
  EXPECT_NEAR(contour_length("G41.1 D.5", {"G3 X5 Y0 J4"}), 23.5619, 1e-4);
}

/// The first axis of G18 is Z, of G19 Y: anticlockwise is from there to the second axis.
TEST(Compensation, OtherPlanes) {
  test::expect_rows({
      test::Row{"F600|G18 G41.1 D1|G1 Z5|X5", "feed 600 to 0.5 0 4.5"},
      test::Row{"F600|G18 G42.1 D1|G1 Z5|X-5", "feed 600 to -0.5 0 4.5"},
      test::Row{"F600|G19 G41.1 D1|G1 Y5|Z5", "feed 600 to 0 4.5 0.5"},
      test::Row{"F600|G19 G41.1 D1|G1 Y5|Y9|X3|Z5", "feed 600 to 0 8.5 0.5; feed 600 to 3 8.5 0.5"},
  });
}

TEST(Compensation, KeepsItsDistanceFromRandomContours) {
  constexpr double tolerance_mm = 1e-3, step_mm = 0.02;
  test::ContourPrograms random(7);
  std::mt19937 radii(8);
  const int count = scaled(300, 50);
  int complete = 0;
  for (int i = 0; i < count; ++i) {
    const double radius = 0.05 + static_cast<double>(radii() % 1000) / 1000;
    const std::vector<std::string> lines = random.ring_program(radius);
    if (random.narrowest() < 2.2 * radius) continue;
    Rig rig;
    rig.options.arc_tolerance_e7 = 100;
    rig.run("G21 F600");
    Travel travel;
    std::array<double, 2> at{};
    bool refused = false;
    std::string text;
    for (const std::string& line : lines) {
      text += line + "\n";
      const Fault fault = rig.interpreter.run(line);
      refused = static_cast<bool>(fault);
      if (refused) {
        EXPECT_EQ(fault.error, GcodeError::cutter_too_large) << text;
        EXPECT_FALSE(rig.interpreter.busy());
        break;
      }
      take(rig, travel, at);
    }
    complete += refused ? 0 : 1;
    double least = 1e9;
    for (std::size_t k = 1; k + 1 < travel.places.size(); ++k) {
      const auto &from = travel.places[k - 1], &to = travel.places[k];
      const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
      const int steps = 1 + static_cast<int>(length / step_mm);
      for (int s = 0; s <= steps; ++s) {
        const double x = from[0] + (to[0] - from[0]) * s / steps;
        const double y = from[1] + (to[1] - from[1]) * s / steps;
        for (const test::ContourBlock& block : random.contour())
          least = std::min(least, test::contour_distance(block, x, y));
      }
    }
    EXPECT_GE(least, radius - tolerance_mm) << text;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(complete, count / 4);
}

TEST(Compensation, MovesAndActionsWait) {
  test::expect_rows({
      test::Row{"F600|G41.1 D1", ""},
      test::Row{"F600|G41.1 D1|G1 X5", ""},
      test::Row{"F600|G41.1 D1|G1 X5|Y5", "feed 600 to 4.5 0.5 0"},
      test::Row{"F600|G41.1 D1|G1 X5|G4 P1", ""},
      test::Row{"F600|G41.1 D1|G1 X5|G4 P1|Z2|Y5",
                "feed 600 to 4.5 0.5 0; dwell 1000000us; feed 600 to 4.5 0.5 2"},
      test::Row{"F600|G41.1 D1|G1 X5|G4 P1|G4 P1|G4 P1|G4 P1", "94@1"},
      test::Row{"F600|G41.1 D1|G1 X5|Y5|M2", "feed 600 to 4.5 5 0; end"},
      test::Row{"F600|G41.1 D1|G1 X5|G40", "feed 600 to 5 0.5 0"},
      test::Row{"F600|G41.1 D1|G1 X5|G40 X9", "feed 600 to 5 0.5 0; feed 600 to 9 0 0"},
      // Only a move in the plane leads to the programmed place.
      test::Row{"F600|G41.1 D1|G1 X5|G40|G0 Z5", "rapid to 5 0.5 5"},
      test::Row{"F600|G41.1 D1|G1 X5|G40|G0 Z5|X9", "rapid to 9 0 5"},
      test::Row{"F600|G41.1 D1|G1 X5|G40|G28 Z1", "rapid to 5 0.5 1 on the way; rapid to 5 0.5 0"},
      test::Row{"F600|G41.1 D1|G1 X5|M2|G91 G0 X1", "rapid to 6 0.5 0"},
      // Across a corner with an angle of 90 degrees to the right the tool on the right cuts it.
      test::Row{"F600|G42.1 D1|G1 X5|Y-5", "feed 600 to 4.5 -0.5 0"},
      test::Row{"F600|G68 R90|G41.1 D1|G1 X5|Y5", "feed 600 to -0.5 4.5 0"},
      test::Row{"F600|G20|G41.1 D1|G1 X5|Y5", "feed 600 to 114.3 12.7 0"},
      test::Row{"F600|G41.1 D0|G1 X5", "feed 600 to 5 0 0"},
  });
}

TEST(Compensation, RefusedLines) {
  const std::string on = "F600|G41.1 D1|G1 X5|";
  const auto after = [&](const std::string& line) {
    Rig rig;
    return rig.run_all(on + line);
  };
  for (const char* line :
       {"G18",    "G20",   "G55",     "G43.1 Z1", "G49",          "G68 R1",   "M6",  "M61 Q1",
        "M70",    "M73",   "M130 P0", "M126 P1",  "G10 L2 P1 X1", "G28",      "G30", "G53 G0 X1",
        "G92 X1", "G92.1", "M0",      "M1",       "G41.1 D1",     "G42.1 D2", "G93"})
    EXPECT_EQ(after(line), "90@1") << line;
  EXPECT_EQ(after("G81 X1 R1 Z-1"), "90@1");
  EXPECT_EQ(after("G5 X1 Y1 I1 J1 P1 Q1"), "90@1");
  EXPECT_EQ(after("X1 Y1 M2"), "90@7");
  EXPECT_EQ(after("G17 G21 G94"), "");
  test::expect_rows({
      test::Row{"G41", "91@1"},
      test::Row{"G42 D3", "95@5"},
      test::Row{"G41.1", "28@1"},
      test::Row{"G41.1 D2001", "39@7"},
      test::Row{"F600|G41.1 D2|G1 X1", "92@1"},
      test::Row{"F600|G41.1 D2|G3 X4 I2", "92@1"},
      test::Row{"F600|G41.1 D1|G1 X5|G40|G3 X6 I.5", "92@1"},
      test::Row{"F600|G41.1 D1|G1 X5|G3 X5 Y.8 J.4", "93@1"},
      test::Row{"F600|G41.1 D1|G1 X5|Y.3|X0", "93@1"},
  });
  Rig rig;
  rig.run_all(on);
  EXPECT_EQ(rig.jog("G91 X1"), "90@1");
}

/// The cutter does not fit into a slot: nothing of the move into it is made, and nothing changes.
TEST(Compensation, RefusalsChangeNothing) {
  Rig rig;
  EXPECT_EQ(rig.run_all("F600|G41.1 D1|G1 X5|X10"), "feed 600 to 5 0.5 0");
  EXPECT_EQ(rig.run("Y0.2"), "feed 600 to 9.5 0.5 0");
  const test::Seen before = rig.seen();
  EXPECT_EQ(rig.run("X5"), "93@1");
  EXPECT_EQ(rig.seen(), before);
  rig.interpreter.reset();
  EXPECT_EQ(rig.run("G0 X1 Y0"), "rapid to 1 0 0");
}

/// Lines at random never do more than they report.
TEST(Compensation, RandomLines) {
  static constexpr const char* parts[] = {
      "G41.1 D1", "G42.1 D.2", "G40",  "G1",     "G0",   "G2",   "G3",  "X1",     "X5",
      "Y2",       "Y-3",       "Z1",   "I1",     "J-1",  "R4",   "G91", "G90",    "G4 P.1",
      "M3 S5",    "M2",        "G18",  "G17",    "M0",   "G28",  "G53", "G92 X1", "G61.1",
      "G20",      "G21",       "G19",  "G81 R1", "F100", "G80",  "M5",  "G95",    "G68 R30",
      "G69",      "M8",        "G5.1", "A3",     "P2",   "#1=3", "X#1", "N7",     "G38.2"};
  std::mt19937 random(3);
  Rig rig;
  for (int i = scaled(60000, 5000); i > 0; --i) {
    std::string line;
    for (auto n = 1 + random() % 4; n != 0; --n) line += parts[random() % std::size(parts)];
    const test::Seen before = rig.seen();
    const Fault fault = rig.interpreter.run(line);
    if (fault) {
      EXPECT_GT(fault.column, 0) << line;
      EXPECT_EQ(rig.seen(), before) << line;
      if (random() % 8 == 0) rig.interpreter.reset();
    } else {
      EXPECT_LT(rig.take().size(), 100'000U) << line;
    }
    EXPECT_FALSE(rig.interpreter.busy());
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace lamplock::program::compensation_test
