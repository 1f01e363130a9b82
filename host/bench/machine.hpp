// Machines with equal axes, for benchmarks and tests of planning.
//
// In:  lamp, acceleration, speed. Out: settings, and the planner's limits for them.
// Who: `lamplock bench`, the tests.
#pragma once

#include "firmware/motion/profile/limits.hpp"

namespace lamplock::bench {

/// Settings of such a machine, with the largest work space that the table of settings allows.
settings::Values machine_settings(double lamp_hz, double accel_m_s2, double speed_m_s, int axes,
                                  double steps_per_mm);

/// Limits of a machine on its nominal beat. Throws std::runtime_error if a setting is refused.
motion::Limits limits_of(const settings::Values& values, std::uint32_t tick_q16 = full_tick_q16);

}  // namespace lamplock::bench
