// Machines with drives of every kind, for tests of the chip.
#pragma once

#include "shared/pulse_times.hpp"
#include "tests/board/turning_job.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {

struct Pulses {
  const char* name;
  PerAxis<PulseMode> modes;
  int step_invert, direction_invert;
  std::int32_t setup_ns, hold_ns;
  std::int32_t high_ns = 500, low_ns = 300;
};
inline constexpr PulseMode step_dir = PulseMode::step_dir, cw_ccw = PulseMode::cw_ccw,
                           quadrature = PulseMode::quadrature;
inline constexpr Pulses pulse_kinds[] = {
    {"step_dir", {step_dir, step_dir, step_dir, step_dir}, 0b0010, 0b0100, 5'000, 20'000},
    {"cw_ccw", {cw_ccw, cw_ccw, cw_ccw, cw_ccw}, 0b0011, 0b0101, 200, 200},
    {"quadrature", {quadrature, quadrature, quadrature, quadrature}, 0b0001, 0b0010, 2'000, 1'000},
    {"mixed", {quadrature, step_dir, cw_ccw, step_dir}, 0, 0, 20'000, 5'000},
    {"long", {step_dir, cw_ccw, quadrature, step_dir}, 0b0001, 0b0010, 200, 200, 2'500, 2'000},
};

inline void PrintTo(const Pulses& pulses, std::ostream* out) { *out << pulses.name; }

inline job::Profile pulse_machine(const Pulses& pulses) {
  job::Profile profile = chip_profile(1000);
  let_speed_jump(profile);
  set_pulses(profile.settings, pulses.modes, pulses.step_invert, pulses.direction_invert,
             pulses.setup_ns, pulses.hold_ns);
  profile.settings.set_milli(Id::step_pulse, pulses.high_ns);
  profile.settings.set_milli(Id::step_low, pulses.low_ns);
  for (int axis = 0; axis < max_axes; ++axis) {
    const Id rate = settings::for_axis(Id::max_rate_x, axis);
    const auto most = static_cast<std::int32_t>(max_rate_milli(profile.settings, axis));
    profile.settings.put_milli(rate, std::min(profile.settings.milli(rate), most));
  }
  return profile;
}

}  // namespace lamplock::test
