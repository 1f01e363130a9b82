// Walks as slave of a lamp with jitter and drift, on the virtual board, against the exact optimum
// for its nominal beat.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "host/bench/machine.hpp"
#include "host/bench/walks.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::bench::slave_walks {
namespace {

constexpr double steps_per_mm = 500;
constexpr int axes = 2;

/// Lamp, acceleration and speed.
struct Kind {
  double lamp_hz, accel_m_s2, speed_m_s;
};
constexpr Kind kinds[] = {{50, 0.5, 0.1}, {50, 2.5, 0.1}, {100, 2, 0.1},
                          {100, 4, 0.1},  {100, 10, 0.1}, {200, 10, 1}};

/// A sine of 2 s that changes by at most 0.3 %/s.
constexpr double wander_period_s = 2;
constexpr double wander_of_drift = 0.003 * wander_period_s / std::numbers::pi;

/// What the lamp does besides its nominal period.
struct Fault {
  const char* name;
  double jitter_us;
  double wander;  ///< peak to peak of the period
};
constexpr Fault faults[] = {{"steady", 0, 0},
                            {"jitter of 20 us", 20, 0},
                            {"drift of 0.3 %/s", 0, wander_of_drift},
                            {"jitter and drift", 20, wander_of_drift}};

job::Profile profile_of(const Kind& kind) {
  job::Profile profile = job::default_profile();
  profile.settings =
      machine_settings(kind.lamp_hz, kind.accel_m_s2, kind.speed_m_s, axes, steps_per_mm);
  profile.settings.set_milli(settings::Id::lamp_mode, 1000);
  profile.settings.set_milli(settings::Id::max_lamp_frequency, 400'000);
  profile.settings.set_milli(settings::Id::max_shot_rate, 400'000);
  return profile;
}

/// Beats of the plan that the board has run: those of shots and of moves.
long beats_on_board(const job::Profile& profile, const std::vector<wire::Target>& walk,
                    const Fault& fault) {
  geometry::PointCloud cloud;
  cloud.reserve(walk.size());
  for (const wire::Target& target : walk)
    cloud.push_back({target.steps[0] / steps_per_mm, target.steps[1] / steps_per_mm, 0});
  sim::LampConfig lamp;
  lamp.jitter_us = fault.jitter_us;
  lamp.wander = fault.wander;
  lamp.wander_period_s = wander_period_s;
  test::Rig rig(profile, lamp);
  const link::JobResult result =
      test::run_job(rig, test::job_for(cloud, profile, wire::JoinMode::free));
  EXPECT_EQ(result.end, link::JobEnd::done);
  EXPECT_EQ(rig.board.controller().clock().lock_losses(), 0u);
  const wire::Status status = rig.status();
  EXPECT_EQ(status.starvations, 0u);
  const auto moving = static_cast<std::size_t>(BeatReason::moving);
  EXPECT_EQ(status.beats_by_reason[moving] + status.shots, status.beats);
  return static_cast<long>(status.beats) + static_cast<long>(status.beats_outside[moving]);
}

/// Beats of the exact optimum: the mean over the phases of the sine, each as if it lasted.
double fewest_beats_at(const settings::Values& values, const std::vector<wire::Target>& walk,
                       double wander) {
  const int phases = wander == 0 ? 1 : 8;
  double sum = 0;
  for (int i = 0; i < phases; ++i) {
    const double share = wander / 2 * std::sin(2 * std::numbers::pi * i / phases);
    const auto tick_q16 = static_cast<std::uint32_t>(std::lround(full_tick_q16 * (1 + share)));
    sum += static_cast<double>(fewest_beats(problem_of(limits_of(values, tick_q16), walk)).beats);
  }
  return sum / phases;
}

class SlaveWalks : public testing::TestWithParam<Kind> {};

TEST_P(SlaveWalks, StayAtTheOptimumThroughJitterAndDrift) {
  const Kind& kind = GetParam();
  const job::Profile profile = profile_of(kind);
  const auto walk = histogram_walk(test::scaled(6000), axes, steps_per_mm, 1);
  const double at_nominal = fewest_beats_at(profile.settings, walk, 0);
  const double at_drift = fewest_beats_at(profile.settings, walk, wander_of_drift);
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    const double optimum = fault.wander == 0 ? at_nominal : at_drift;
    const auto beats = static_cast<double>(beats_on_board(profile, walk, fault));
    std::cout << kind.lamp_hz << " Hz, " << kind.accel_m_s2 << " m/s2, " << fault.name << ": "
              << beats << " beats, optimum " << optimum << " (" << 100 * (beats / optimum - 1)
              << " % more)\n";
    // One beat is more than 0.1 % of a short walk.
    EXPECT_LE(beats, 1.001 * optimum + 1);
    if (fault.wander == 0) {
      EXPECT_GE(beats, optimum);
    }
  }
}

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  return std::to_string(static_cast<int>(info.param.lamp_hz)) + "Hz_" +
         std::to_string(static_cast<int>(info.param.accel_m_s2 * 10)) + "dm_s2";
}
INSTANTIATE_TEST_SUITE_P(Machines, SlaveWalks, testing::ValuesIn(kinds), name_of);

}  // namespace
}  // namespace lamplock::bench::slave_walks
