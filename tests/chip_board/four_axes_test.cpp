// Fast steps on four axes at once, locked to a lamp, with the default set-up and hold times: 250
// kHz in every pulse mode, 500 kHz as STEP and DIR. Every step is on the tick of the plan, and the
// same step as that of the virtual board, so that also the positions between the shots are right.
#include <fmt/format.h>

#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

constexpr int axes = 4;

constexpr int fast_mm_s = 200;

struct Fast {
  int lamp_hz;
  PulseMode mode;
  int steps_s = 250'000;
  int steps_per_mm() const { return steps_s / fast_mm_s; }
};

/// Such steps at 200 mm/s, a map with four axes. The plan stays below the limit by what the lamp
/// may gain meanwhile (1 to 3 %), so the limit is set slightly higher.
job::Profile fast_profile(const Fast& fast) {
  job::Profile profile = chip_profile(fast.lamp_hz);
  settings::Values& values = profile.settings;
  values.set_milli(Id::pin_map, 1000);
  values.set_milli(Id::axes, axes * 1000);
  for (int axis = 0; axis < axes; ++axis) {
    const auto set = [&values, axis](Id first, std::int32_t milli) {
      ASSERT_TRUE(values.set_milli(static_cast<Id>(static_cast<int>(first) + axis), milli));
    };
    set(Id::steps_per_mm_x, fast.steps_per_mm() * 1000);
    set(Id::max_rate_x, 207 * 60'000);
    set(Id::acceleration_x, 4'000'000);
    set(Id::pulse_mode_x, static_cast<int>(fast.mode) * 1000);
  }
  return profile;
}

/// Long straight moves of all axes, there and back; many beats between two shots.
job::Job fast_job(const job::Profile& profile, int steps_per_mm) {
  const std::array<int, 6> places_mm{-25, 25, -20, 22, -25, 0};
  geometry::PointCloud points;
  for (const int mm : places_mm) points.push_back({1.0 * mm, -1.0 * mm, 1.0 * mm});
  job::Job job = job::make_job(points, profile, {});
  for (std::size_t i = 0; i < places_mm.size(); ++i)
    for (std::size_t axis = 0; axis < axes; ++axis)
      job.targets[i].steps[axis] = places_mm[i] * (axis % 2 == 0 ? steps_per_mm : -steps_per_mm);
  return job;
}

/// Highest step rate of an axis over a `window`, steps/s.
double fastest_rate(const std::vector<PinMonitor::Step>& steps, Picoseconds window) {
  std::size_t most = 0;
  for (std::size_t first = 0, last = 0; last < steps.size(); ++last) {
    while (steps[last].at - steps[first].at >= window) ++first;
    most = std::max(most, last - first + 1);
  }
  return static_cast<double>(most) * ps_per_s / static_cast<double>(window);
}

/// The steps of each axis on the virtual board.
PerAxis<std::vector<PinMonitor::Step>> virtual_steps(const job::Profile& profile,
                                                     const job::Job& job) {
  sim::VirtualBoard board(profile.settings, world_for(profile));
  const StepLog log(profile.settings, board.bus());
  board.run_until(ps_per_ms);
  link::SimulatedTransport transport(board);
  link::JobSender sender(transport, job, RunningJob::options(1, 0));
  EXPECT_EQ(sender.run().end, JobEnd::done);
  return log.steps();
}

/// The same positions on the same ticks since the first step, whose time the board's latency sets.
void expect_same_ways(const std::vector<PinMonitor::Step>& made,
                      const std::vector<PinMonitor::Step>& planned, int axis) {
  ASSERT_EQ(made.size(), planned.size()) << axis;
  Picoseconds largest = 0;
  for (std::size_t i = 0; i < made.size(); ++i) {
    ASSERT_EQ(made[i].position, planned[i].position) << axis << ", step " << i;
    largest = std::max(
        largest, std::abs((made[i].at - made.front().at) - (planned[i].at - planned.front().at)));
  }
  EXPECT_LT(largest, ps_per_tick) << axis;
}

class FourAxes : public testing::TestWithParam<Fast> {};

TEST_P(FourAxes, StepAtOnceWhileLocked) {
  const Fast& fast = GetParam();
  const PulseMode mode = fast.mode;
  const job::Profile profile = fast_profile(fast);
  const job::Job job = fast_job(profile, fast.steps_per_mm());
  ChipRig rig(profile, ChipRig::Power::off);
  const StepLog log(profile.settings, rig.board.bus());
  const sim::BoardTiming timing(rig.board, flash_image());
  rig.boot();
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job));
  if (mode == PulseMode::step_dir) {
    EXPECT_EQ(rig.monitor.violation(profile.settings), "");
  }
  const auto planned = virtual_steps(profile, job);
  constexpr Picoseconds stretch = 50 * ps_per_ms;
  for (int axis = 0; axis < axes; ++axis) {
    const auto place = static_cast<std::size_t>(axis);
    const auto& steps = log.steps()[place];
    EXPECT_GE(fastest_rate(steps, stretch), fast.steps_s) << axis;
    expect_same_ways(steps, planned[place], axis);
    // No step is lost or doubled: the axis is at the place of the last shot.
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps.back().position, job.targets.back().steps[place]) << axis;
    for (std::size_t i = 0; i < rig.shots().size(); ++i)
      EXPECT_NEAR(rig.shots()[i].steps[place], job.targets[i].steps[place], 1) << i;
  }
  const sim::TimingTable table =
      timing.table(profile.settings.milli(Id::q_switch_delay) * ps_per_us / 1000);
  std::printf("%s", sim::timing_text(table).c_str());
  // Every shot is earlier than the set delay: by a clock, and by as many as cover 8 ns
  // (lamp/shot_delay.hpp).
  const auto clock_ns = static_cast<double>(rig.clock()) / ps_per_ns;
  const double early_ns = clock_ns + std::ceil(8 / clock_ns) * clock_ns;
  EXPECT_EQ(table.phase_worst_ns, early_ns);
  EXPECT_EQ(table.phase_mean_ns, -early_ns);
  EXPECT_EQ(table.step_error_worst_ns, 0);
  EXPECT_LE(table.max_masked_us, 1.0);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

std::string name_of(const testing::TestParamInfo<Fast>& fast) {
  constexpr std::array modes{"", "CwCcw", "Quadrature"};
  return fmt::format("{}Hz{}{}", fast.param.lamp_hz,
                     modes[static_cast<std::size_t>(fast.param.mode)],
                     fast.param.steps_s == 500'000 ? "500kHz" : "");
}

// The cost is one of ticks, not of steps: the two rates of STEP and DIR share the three lamps.
INSTANTIATE_TEST_SUITE_P(Lamps, FourAxes,
                         testing::Values(Fast{100, PulseMode::step_dir, 500'000},
                                         Fast{1000, PulseMode::step_dir},
                                         Fast{4000, PulseMode::step_dir, 500'000},
                                         Fast{4000, PulseMode::cw_ccw},
                                         Fast{4000, PulseMode::quadrature}),
                         name_of);

}  // namespace
}  // namespace lamplock::test
