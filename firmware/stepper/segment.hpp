// A segment: a run of ticks from one point to the next, exact to the tick and the step.
//
// In:  made by the planner (main loop).
// Out: read by the tick generator (interrupt), which needs no division to run it.
//
// Per axis the speed is piecewise linear over three phases: `lead` ticks at lead_accel, `cruise`
// ticks at constant speed, the rest at tail_accel. Positions at ticks lie exactly on the continuous
// parabola P + n v + n^2 A / 2: the rate that tick j adds is the speed in the middle of the tick,
// v + (j + 1/2) A. Accelerations are even numbers of 2^-62, so that the half is exact.
#pragma once

#include <cstdint>

#include "shared/beat_reason.hpp"
#include "shared/fixed_point.hpp"
#include "shared/units.hpp"

namespace lamplock::stepper {

/// Motion of one axis during a segment.
struct AxisProfile {
  std::int64_t speed_q62 = 0;       ///< at the start, steps per tick
  std::int64_t lead_accel_q62 = 0;  ///< steps per tick squared
  std::int64_t tail_accel_q62 = 0;
  std::uint32_t lead_ticks = 0;
  std::uint32_t cruise_ticks = 0;
  std::uint32_t tail_ticks = 0;
  std::uint32_t lead_turn_ticks = 0;  ///< ticks of the lead before its rate changes sign; 0 = never
  std::uint32_t tail_turn_ticks = 0;  ///< the same for the tail

  constexpr std::uint32_t ticks() const { return lead_ticks + cruise_ticks + tail_ticks; }
  constexpr std::int64_t cruise_speed_q62() const {
    return speed_q62 + lead_accel_q62 * static_cast<std::int64_t>(lead_ticks);
  }
  constexpr std::int64_t end_speed_q62() const {
    return cruise_speed_q62() + tail_accel_q62 * static_cast<std::int64_t>(tail_ticks);
  }
};

/// Displacement of n ticks from speed v with (even) acceleration A, Q62 (exact).
constexpr Int128 displacement_q62(std::int64_t speed_q62, std::int64_t accel_q62, std::uint32_t n) {
  if (n == 0) return {};
  if (accel_q62 == 0) return Int128::product(speed_q62, n);
  const auto square = static_cast<std::int64_t>(wide_product(n, n));
  return Int128::product(speed_q62, n) + Int128::product(accel_q62 / 2, square);
}

/// Displacement of a whole profile, Q62 (exact).
constexpr Int128 displacement_q62(const AxisProfile& p) {
  const std::int64_t cruise = p.cruise_speed_q62();
  return displacement_q62(p.speed_q62, p.lead_accel_q62, p.lead_ticks) +
         displacement_q62(cruise, 0, p.cruise_ticks) +
         displacement_q62(cruise, p.tail_accel_q62, p.tail_ticks);
}

/// Where an axis is and how fast: position in steps with a Q64 fraction.
struct AxisState {
  Int128 position_q64;
  std::int64_t speed_q62 = 0;

  std::int32_t step() const { return static_cast<std::int32_t>(position_q64.hi()); }
};

/// State of all axes at a tick.
struct MotionState {
  std::uint64_t tick = 0;
  PerAxis<AxisState> axis{};

  bool at_rest() const {
    for (const AxisState& a : axis)
      if (a.speed_q62 != 0) return false;
    return true;
  }
};

/// Position of the middle of a step, where an axis stands at an integer point.
constexpr Int128 middle_of_step(std::int32_t step) {
  return {static_cast<std::uint64_t>(static_cast<std::int64_t>(step)), half_step_q64};
}

/// The shot that a segment ends with.
struct SegmentShot {
  bool present = false;
  std::uint32_t half_window_ticks = 0;  ///< ticks around the lattice tick inside the tolerance
  std::uint8_t channel = 0;
  std::uint16_t energy = 0;
};

/// Motion of all axes from one beat to a later one.
struct Segment {
  std::uint64_t start_tick = 0;
  std::uint32_t ticks = 0;
  BeatReason reason = BeatReason::moving;  ///< of the beats that pass inside
  bool ends_point = false;                 ///< the end is a target of the job
  std::uint32_t point = 0;                 ///< its index
  SegmentShot shot;
  PerAxis<AxisProfile> axis{};
  MotionState end;  ///< state after the last tick: where the next segment starts

  std::uint64_t end_tick() const { return start_tick + ticks; }
};

}  // namespace lamplock::stepper
