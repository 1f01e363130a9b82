// The planner against what the source documents measured and claim, and against the exact optimum
// on long streams.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>

#include "host/bench/figures.hpp"
#include "tests/scale.hpp"

namespace lamplock::bench {
namespace {

/// Numbers of a table as published, without its heading.
std::vector<std::vector<double>> read_table(const std::string& name) {
  std::ifstream file(std::string(LAMPLOCK_ROOT "/tests/data/") + name);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string cell;
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

TEST(Golden, TablesAreAsPublished) {
  const auto times = read_table("glass_start_stop_times.csv");
  ASSERT_EQ(times.size(), glass_start_stop_times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const StartStopTime& row = glass_start_stop_times[i];
    ASSERT_EQ(times[i].size(), 5u);
    EXPECT_EQ(times[i][0], row.lamp_hz);
    EXPECT_EQ(times[i][1], row.speed_m_s);
    EXPECT_EQ(times[i][2], row.accel_m_s2);
    EXPECT_EQ(times[i][3], row.time_s);
    EXPECT_NEAR(times[i][4], glass_points / row.time_s, 0.01) << "row " << i;
  }
  const auto lengths = read_table("glass_step_length_histogram.csv");
  ASSERT_EQ(lengths.size(), glass_step_lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_EQ(lengths[i][0], glass_step_lengths[i].step_um);
    EXPECT_EQ(lengths[i][1], glass_step_lengths[i].fraction);
  }
}

TEST(Golden, StartStopReproducesTheMeasuredTimes) {
  double worst = 0;
  for (const StartStopTime& row : glass_start_stop_times) {
    const double error = start_stop_on_one_axis(row) / measured_beats(row) - 1;
    worst = std::max(worst, std::fabs(error));
    EXPECT_LT(std::fabs(error), 0.01)
        << row.lamp_hz << " Hz, " << row.accel_m_s2 << " m/s2, " << row.speed_m_s << " m/s";
  }
  std::cout << "measured start-stop times: worst row " << 100 * worst << " %\n";
}

/// Rows that differ in what `same` ignores.
template <class Same>
std::vector<std::pair<StartStopTime, StartStopTime>> pairs(Same same) {
  std::vector<std::pair<StartStopTime, StartStopTime>> found;
  for (std::size_t i = 0; i < glass_start_stop_times.size(); ++i)
    for (std::size_t k = i + 1; k < glass_start_stop_times.size(); ++k)
      if (same(glass_start_stop_times[i], glass_start_stop_times[k]))
        found.emplace_back(glass_start_stop_times[i], glass_start_stop_times[k]);
  return found;
}

double apart(double a, double b) { return std::fabs(a / b - 1); }

TEST(Golden, BeatsDependOnAccelerationOverFrequencySquaredAlone) {
  const auto two_lamps = pairs([](const StartStopTime& a, const StartStopTime& b) {
    return a.lamp_hz != b.lamp_hz && a.speed_m_s == b.speed_m_s &&
           a.accel_m_s2 * b.lamp_hz * b.lamp_hz == b.accel_m_s2 * a.lamp_hz * a.lamp_hz;
  });
  EXPECT_EQ(two_lamps.size(), 2u);
  for (const auto& [a, b] : two_lamps) {
    EXPECT_LT(apart(measured_beats(a), measured_beats(b)), 0.01);
    // Also each measured row from ours at the other lamp, but for the few steps of the histogram
    // that run at full speed: these know the speed as well.
    EXPECT_LT(apart(start_stop_on_one_axis(a), measured_beats(b)), 0.015);
    EXPECT_LT(apart(start_stop_on_one_axis(b), measured_beats(a)), 0.015);
  }
  // With the speed scaled alike, every row of one lamp is one of the other.
  for (StartStopTime row : glass_start_stop_times) {
    const double slow = start_stop_on_one_axis(row);
    row.lamp_hz *= 2;
    row.accel_m_s2 *= 4;
    row.speed_m_s *= 2;
    EXPECT_LT(apart(start_stop_on_one_axis(row), slow), 0.001) << row.accel_m_s2;
  }
}

TEST(Golden, TheTwoSpeedsTakeTheSameTime) {
  const auto two_speeds = pairs([](const StartStopTime& a, const StartStopTime& b) {
    return a.lamp_hz == b.lamp_hz && a.speed_m_s != b.speed_m_s && a.accel_m_s2 == b.accel_m_s2;
  });
  EXPECT_EQ(two_speeds.size(), 24u);
  for (const auto& [a, b] : two_speeds) {
    EXPECT_LT(apart(measured_beats(a), measured_beats(b)), 0.006) << a.accel_m_s2;
    EXPECT_LT(apart(start_stop_on_one_axis(a), start_stop_on_one_axis(b)), 0.006) << a.accel_m_s2;
  }
}

TEST(Golden, FreePlanningStaysAtTheOptimumOnLongWalks) {
  const int points = std::min(graded_points, test::scaled(2'000));
  for (const Machine& machine : graded_walks) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const Figures f = walk_figures(machine, points, seed);
      std::cout << machine.lamp_hz << " Hz, " << machine.accel_m_s2 << " m/s2, " << points
                << " points, seed " << seed << ": start-stop " << f.start_stop << ", free "
                << f.free << ", optimum " << f.optimum << " (+" << f.gap_percent() << " %)\n";
      EXPECT_GE(f.free, f.optimum);
      EXPECT_LE(f.gap_percent(), 0.1);
      EXPECT_LT(f.free, f.start_stop);
    }
  }
}

TEST(Golden, TheLowerTheJerkTheMoreBeats) {
  const Machine machine{200, 10, 1};
  const JerkBeats beats = jerk_beats(machine, 400, 3);
  EXPECT_DOUBLE_EQ(beats[0], walk_figures(machine, 400, 3).free) << "no limit is no limit";
  for (std::size_t i = 1; i < beats.size(); ++i) EXPECT_GT(beats[i], beats[i - 1] * 0.99) << i;
  EXPECT_GT(beats.back(), 3 * beats.front());
  // Half the jerk is the same motion in 2^(1/3) of the time, where speeds do not matter.
  EXPECT_NEAR(beats[7] / beats[6], std::cbrt(2), 0.06);
}

TEST(Golden, TheExampleOfTheThesisTakesFortyPerCentLessTimeAndMore) {
  for (const PulseCourse& row : pulse_courses) {
    SCOPED_TRACE(row.name);
    const Figures f = course_figures(row, 1);
    std::cout << row.name << ": start-stop " << f.start_stop << ", free " << f.free << ", optimum "
              << f.optimum << "\n";
    EXPECT_NEAR(f.start_stop, 2, 0.005);
    EXPECT_LE(f.free, f.optimum * 1.001);
    EXPECT_GE(f.free, f.optimum);
    EXPECT_GE(f.saved_percent(), 40);
    // Where it turns back nobody can do better than 1.06.
    if (row.shape != Course::zigzag) {
      EXPECT_LE(f.free, 1.02);
    }
  }
}

}  // namespace
}  // namespace lamplock::bench
