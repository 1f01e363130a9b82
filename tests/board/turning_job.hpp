// A machine that turns at full speed, and a job in which steps in opposite directions are closer
// together than drives permit.
//
// Used by tests of pulse modes and reversals, on both boards.
#pragma once

#include <random>

#include "host/job/job.hpp"

namespace lamplock::test {

/// Permits speed jumps above the machine's top speed; 1000 steps/mm, at most 400 000 steps/s.
inline void let_speed_jump(job::Profile& profile) {
  using settings::Id;
  for (int axis = 0; axis < 3; ++axis) {
    const auto set = [&](Id id, double value) {
      job::state_setting(profile, settings::for_axis(id, axis), value, "test");
    };
    set(Id::steps_per_mm_x, 1000);
    set(Id::max_rate_x, 24'000);
    set(Id::speed_jump_x, 500);
    set(Id::acceleration_x, 20'000);
    set(Id::travel_x, 1000);
    set(Id::min_corner_x, -500);
  }
}

/// Back and forth between 150 points; with a lamp of 1 kHz some 100 steps per millisecond.
inline job::Job turning_job(const job::Profile& profile, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> width(0.02, 0.12);
  geometry::PointCloud points{{0, 0, 0}};
  for (int i = 0, way = 1; i < 150; ++i, way = -way)
    points.push_back({way * width(random), way * width(random) / 2, way * width(random) / 10});
  job::JobOptions options;
  options.mode = wire::JoinMode::path;
  return job::make_job(points, profile, options);
}

/// Sets the pulses as in the settings table.
inline void set_pulses(settings::Values& values, const PerAxis<PulseMode>& modes, int step_invert,
                       int direction_invert, std::int32_t setup_ns, std::int32_t hold_ns) {
  for (int axis = 0; axis < max_axes; ++axis)
    values.set_milli(settings::for_axis(Id::pulse_mode_x, axis),
                     static_cast<int>(modes[index(axis)]) * 1000);
  values.set_milli(Id::step_invert, step_invert * 1000);
  values.set_milli(Id::direction_invert, direction_invert * 1000);
  values.set_milli(Id::direction_setup, setup_ns);
  values.set_milli(Id::direction_hold, hold_ns);
}

}  // namespace lamplock::test
