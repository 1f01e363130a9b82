// G-code programs on the chip: lines per second, and the path at any requested speed.
// ticks_test.cpp compares programs with the virtual board.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/program/program_run.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// A machine with 5 um steps, 10 m/s2, 1 m/s, and no lamp.
job::Profile quick_machine() {
  job::Profile profile = chip_profile(500);
  job::set_acceleration(profile, 10);
  job::set_speed(profile, 1);
  profile.settings.set_milli(Id::lamp_mode, 0);
  return profile;
}

/// Lines of `mm` on a spiral of some 20 mm.
std::string spiral(std::size_t lines, double mm, double feed_mm_min) {
  std::string text = fmt::format("G0 X20\nF{}\n", feed_mm_min);
  double angle = 0, radius = 20;
  for (std::size_t i = 0; i < lines; ++i) {
    angle += mm / radius;
    radius -= 1e-4;
    text += fmt::format("G1X{:.3f}Y{:.3f}\n", radius * std::cos(angle), radius * std::sin(angle));
  }
  return text;
}

/// Runs until the machine is at rest again; no line is refused.
void run(ChipRig& rig, std::string_view text, Picoseconds end) {
  rig.user.give(text);
  EXPECT_TRUE(rig.user.run_until_answered(end));
  EXPECT_EQ(rig.user.errors(), 0u);
  EXPECT_TRUE(rig.user.run_until_idle(end));
}

/// 50 um at 100 mm/s are 2000 lines per second: the machine reaches the speed only if lines are
/// parsed and planned at that rate.
TEST(ChipProgram, RunsTwoThousandLinesASecond) {
  const job::Profile profile = quick_machine();
  const auto lines = static_cast<std::size_t>(scaled(1000));
  const std::string text = spiral(lines, 0.05, 6000);
  const auto plan = program_run::run_program(text, profile.settings, 1);
  ASSERT_TRUE(plan.problems.empty());
  ChipRig rig(profile);
  const Picoseconds begin = rig.now();
  run(rig, text, begin + 60 * ps_per_s);
  EXPECT_EQ(rig.user.answers().size(), lines + 2);
  const double seconds = sim::seconds(rig.now() - begin);
  const double answered =
      sim::seconds(rig.user.answer_times().back() - rig.user.answer_times().front());
  std::cout << fmt::format(
      "{} lines of 50 um in {:.3f} s, planned {:.3f} s; answered {:.0f} lines/s\n", lines, seconds,
      plan.seconds(), static_cast<double>(lines) / answered);
  EXPECT_LE(seconds, 1.05 * plan.seconds() + 0.02);
}

/// Largest distance of the machine from the spiral of spiral() in lines of 20 um, mm. The radius
/// falls by 1e-4 mm per line, in which the angle grows by 0.02 mm / radius: exponentially.
double way_off(const ChipRig& rig, double steps_per_mm) {
  std::map<Picoseconds, std::pair<int, std::int32_t>> steps;
  for (int axis : {0, 1})
    for (const PinMonitor::Step& step : rig.monitor.steps(axis))
      steps[step.at + axis] = {axis, step.position};  // a picosecond apart
  std::array<double, 2> at{};
  double off = 0, angle = 0;
  bool begun = false;
  for (const auto& [time, step] : steps) {
    at[static_cast<std::size_t>(step.first)] = step.second / steps_per_mm;
    begun = begun || step.first == 1;  // the move to the beginning comes first
    if (!begun) continue;
    angle += std::remainder(std::atan2(at[1], at[0]) - angle, 2 * std::numbers::pi);
    off = std::max(off, std::abs(std::hypot(at[0], at[1]) - 20 * std::exp(-angle * 1e-4 / 0.02)));
  }
  return off;
}

/// 20 um at 100 mm/s are 5000 lines a second.
TEST(ChipProgram, RunsFiveThousandLinesASecond) {
  const job::Profile profile = quick_machine();
  const auto lines = static_cast<std::size_t>(scaled(1500));
  const std::string text = spiral(lines, 0.02, 6000);
  const auto plan = program_run::run_program(text, profile.settings, 1);
  ChipRig rig(profile);
  const Picoseconds begin = rig.now();
  run(rig, text, begin + 60 * ps_per_s);
  const double seconds = sim::seconds(rig.now() - begin);
  std::cout << fmt::format("{} lines of 20 um in {:.3f} s, planned {:.3f} s\n", lines, seconds,
                           plan.seconds());
  EXPECT_LE(seconds, 1.03 * plan.seconds() + 0.02);
}

/// Far more lines per second than the board can read: the machine slows down, brakes where the next
/// batch is late, also while that batch is handed out, resumes from its place, and stays on its
/// path.
TEST(ChipProgram, KeepsItsPathAtAnyRequestedSpeed) {
  const job::Profile profile = quick_machine();
  ChipRig rig(profile);
  // The first tenth of a second fills the buffers.
  const auto lines = static_cast<std::size_t>(scaled(2000, 2000));
  const Picoseconds begin = rig.now();
  run(rig, spiral(lines, 0.02, 30'000), begin + 60 * ps_per_s);
  // Two steps of 5 um, and the deviation at junctions and chords.
  EXPECT_LE(way_off(rig, 200), 0.025);
  EXPECT_GE(static_cast<double>(lines) / sim::seconds(rig.now() - begin), 3500);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

/// With motors that combine two axes the board reads fewer lines per second, but not even fewer
/// when more are requested.
TEST(ChipProgram, ACoreXyIsNotSlowerAtExcessiveSpeeds) {
  job::Profile profile = quick_machine();
  profile.settings.set_milli(Id::kinematics, 1000);
  std::vector<double> rates;
  for (const double feed_mm_s : {100, 500}) {
    ChipRig rig(profile);
    // The first tenth of a second fills the buffers.
    const auto lines = static_cast<std::size_t>(scaled(2000, 2000));
    const Picoseconds begin = rig.now();
    run(rig, spiral(lines, 0.02, feed_mm_s * 60), begin + 60 * ps_per_s);
    rates.push_back(static_cast<double>(lines) / sim::seconds(rig.now() - begin));
    std::cout << feed_mm_s << " mm/s: " << rates.back() << " lines/s\n";
  }
  for (const double rate : rates) EXPECT_GE(rate, 0.9 * rates.front());
}

TEST(ChipProgram, EndsAtItsPlaceThoughLinesAreLate) {
  const job::Profile profile = quick_machine();
  for (const double feed_mm_s : {80, 100, 250}) {
    SCOPED_TRACE(feed_mm_s);
    const std::string text =
        spiral(static_cast<std::size_t>(scaled(600)), 0.02, feed_mm_s * 60) + "X1 Y2\n";
    ChipRig rig(profile);
    run(rig, text, rig.now() + 60 * ps_per_s);
    EXPECT_EQ(rig.board.world().drives().position(), (StepPosition{200, 400, 0, 0}));
    EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
  }
}

}  // namespace
}  // namespace lamplock::test
