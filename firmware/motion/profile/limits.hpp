// The machine's limits in the planner's units.
//
// In:  settings (mm, mm/min, mm/s2, m/s3) and the length of a beat in ticks.
// Out: per axis, limits in steps and ticks, and the same normalised for reach.hpp and
//      scaled_reach.hpp.
// Who: once per job (main loop), and when the tracked lamp period or the job speed has changed
//      (main loop, or the core that plans).
#pragma once

#include <cstdint>

#include "firmware/motion/profile/scaled_reach.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/beat.hpp"
#include "shared/fixed_point.hpp"
#include "shared/result.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// An acceleration that the jerk reaches in this time needs no ramp: half of the shortest stair.
inline constexpr std::uint32_t flat_rise_ticks = stepper::min_stair_ticks / 2;

/// Limits of one axis.
struct AxisLimits {
  std::int64_t speed_q62 = 0;  ///< steps per tick, never exceeded at any tick
  std::int64_t accel_q62 = 0;  ///< steps per tick squared, never exceeded at any tick
  std::int64_t jump_q62 = 0;   ///< maximum jump of the speed at a corner of a path, steps per tick
  std::uint32_t weight_q31 = std::uint32_t{1}
                             << 31;  ///< steps/mm of the coarsest axis over its own
  std::int32_t min_steps = 0;        ///< work space, inclusive
  std::int32_t max_steps = 0;
  // Planning limits: a little less, so that rounding to whole ticks stays inside.
  std::int64_t plan_speed_q62 = 0;
  std::int64_t plan_accel_q62 = 0;
  std::int64_t brake_accel_q62 = 0;  ///< of brakes; more than the last one only if jerk is limited
  std::int64_t jerk_q78 = 0;         ///< steps per tick cubed; 0 = not limited
  /// time of the jerk to reach brake_accel, plus the cost of rounding
  std::uint32_t rise_ticks = 0;
  std::int64_t speed_q32 = 0;  ///< normalised speed limit, beats
  AxisScale scale;             ///< the same for the search
  std::uint32_t per_accel =
      0;  ///< 1 / (acceleration per beat squared) = per_accel / 2^per_accel_shift
  int per_accel_shift = 0;
  std::int64_t shot_tolerance_q32 = 0;  ///< steps
  std::int64_t shot_way_q32 = 0;        ///< the same normalised

  /// d/A in beats squared, Q32, of a displacement in steps, Q32; limited to +-2^62, more than any
  /// number of beats can cover.
  std::int64_t displacement_q32(std::int64_t steps_q32) const {
    constexpr std::int64_t largest = std::int64_t{1} << 62;
    const Int128 q = Int128::product(steps_q32, per_accel) >> per_accel_shift;
    if (q > Int128(largest)) return largest;
    return q < Int128(-largest) ? -largest : q.to_int64();
  }
  /// The same of whole steps, scaled like the axis' speeds and rounded down.
  std::int64_t displacement_qs(std::int64_t steps) const {
    const int shift = per_accel_shift - scale.bits;
    const std::int64_t size = abs64(steps);
    if (shift < 0 || shift > 62 || size >> 31 != 0)
      return displacement_q32(steps << 32) >> (32 - scale.bits);
    const std::uint64_t product = wide_product(static_cast<std::uint32_t>(size), per_accel);
    if (steps >= 0) return static_cast<std::int64_t>(product >> shift);
    return -static_cast<std::int64_t>((product + (std::uint64_t{1} << shift) - 1) >> shift);
  }
};

/// Limits of all axes for one length of the beat.
struct Limits {
  int axes = 0;
  std::uint32_t beat_ticks = 0;  ///< N: ticks in a beat
  PerAxis<AxisLimits> axis{};

  /// True if jerk is limited on any axis.
  bool jerk_limited() const;
  /// Steps per tick, Q62, of a normalised speed of an axis.
  std::int64_t speed_q62(int a, std::int64_t v_q32) const {
    return mul_q32(v_q32, axis[static_cast<std::size_t>(a)].plan_accel_q62) *
           static_cast<std::int64_t>(beat_ticks);
  }
};

/// Limits for brakes of an axis: a part of AxisLimits.
struct AxisBrake {
  std::int64_t accel_q62 = 0;  ///< steps per tick squared
  std::int64_t jerk_q78 = 0;
  std::uint32_t rise_ticks = 0;
  std::int32_t min_steps = 0;
  std::int32_t max_steps = 0;

  AxisBrake() = default;
  explicit AxisBrake(const AxisLimits& axis);
};

/// The same for all axes.
struct BrakeLimits {
  int axes = 0;
  PerAxis<AxisBrake> axis{};

  /// True if jerk is limited on any axis.
  bool jerk_limited() const;

  BrakeLimits() = default;
  /// Conversion, for where limits are at hand.
  BrakeLimits(const Limits& limits);  // NOLINT(google-explicit-constructor)
};

/// Highest acceleration of pulses on an axis, with room for the rounding of their ramps.
std::int64_t pulse_peak_q62(const AxisLimits& axis, std::uint32_t beat_ticks);

/// Fills `out`. `tick_q16` is the shortest real tick to expect over the nominal one: a shorter tick
/// makes real speed and acceleration larger, so the limits in ticks fall with its first and second
/// power. Error: bad_value, with the number of the offending setting in `setting`.
Result make_limits(const settings::Values& values, std::uint32_t beat_ticks, std::uint32_t tick_q16,
                   Limits& out, std::uint16_t& setting);

}  // namespace lamplock::motion
