// A segment: a run of ticks from one point to the next, exact to the tick and the step.
//
// In:  made by the planner (main loop, or the core that plans); brakes by the job runner; pushed to
//      the queue by the main loop.
// Out: read by the tick generator (fill interrupt), which runs it without a division.
//
// Per axis the speed is piecewise linear over three phases: `lead` ticks at lead_accel, `cruise`
// ticks at constant speed, the rest at tail_accel. Positions at ticks lie exactly on the continuous
// parabola P + n v + n^2 A / 2: the rate that tick j adds is the speed in the middle of the tick, v
// + (j + 1/2) A. Accelerations are even numbers of 2^-62, so that the half is exact.
//
// Where jerk is limited a phase is a pulse: its acceleration climbs to A in equal stairs, stays
// there, and falls in the same stairs. Stair i of K is (i - 1/2) A/K high, the mean of a straight
// ramp, so at the ends of stairs the speed is that of the ramp, and at every tick the acceleration
// is within half a stair of it. A pulse is symmetric in time: over n ticks with ramps of r ticks it
// changes the speed by A (n - r) and its mean speed is that in its middle, both exactly as constant
// acceleration A (n - r)/n would. A pulse begins and ends within half a stair of acceleration zero.
//
// A segment of a program may have power for a continuous laser: it changes evenly over lead and
// tail and is constant in between (segment_power.hpp), or follows cells of equal length along the
// line (beam_axis.hpp). A segment has power or ends with a shot, not both.
#pragma once

#include <cstdint>

#include "shared/beat_reason.hpp"
#include "shared/fixed_point.hpp"
#include "shared/units.hpp"

namespace lamplock::stepper {

/// How the acceleration of a phase climbs and falls; no stairs = it is constant.
struct Ramp {
  int log_stairs = 0;
  std::uint32_t stair_ticks = 0;

  constexpr std::uint32_t stairs() const { return std::uint32_t{1} << log_stairs; }
  constexpr std::uint32_t ticks() const { return stair_ticks << log_stairs; }
};

/// Length of the longest ramp, half a pulse, in 256ths of the phase.
inline constexpr std::uint8_t max_ramp = 128;
/// Ramp of a phase that is the second half of a pulse, of a motion that was interrupted: it only
/// falls.
inline constexpr std::uint8_t falling_ramp = 255;
/// At most four stairs, none shorter than this unless the phase is: each stair costs the board a
/// block, some 40 us on the Cortex-M0+.
inline constexpr int max_log_stairs = 2;
inline constexpr std::uint32_t min_stair_ticks = 256 * (ticks_per_second / 1'000'000);
/// Accelerations of pulses are whole multiples of this, so that every stair is an even number.
inline constexpr std::int64_t pulse_accel_unit = std::int64_t{4} << max_log_stairs;

/// The ramps of a phase of n ticks that is a pulse or the second half of one.
Ramp ramp_of(std::uint32_t n, std::uint8_t ramp);
/// Ticks at full acceleration that change the speed as much as such a phase does.
std::uint32_t pulse_ticks(std::uint32_t n, std::uint8_t ramp);
/// The same for any phase.
inline std::uint32_t full_ticks(std::uint32_t n, std::uint8_t ramp) {
  return ramp == 0 ? n : pulse_ticks(n, ramp);
}

/// A stretch of constant acceleration.
struct Stair {
  std::int64_t accel_q62 = 0;
  std::uint32_t ticks = 0;
};

/// Number of the first stair of a phase; some may be empty.
inline std::uint32_t first_stair(std::uint8_t ramp) {
  return ramp == falling_ramp ? 1u << max_log_stairs : 0;
}
/// Stair i of a phase of n ticks that has ramps; false after the last one.
bool next_ramp_stair(std::int64_t accel_q62, std::uint32_t n, std::uint8_t ramp, std::uint32_t i,
                     Stair& stair);
/// The same for any phase.
inline bool next_stair(std::int64_t accel_q62, std::uint32_t n, std::uint8_t ramp, std::uint32_t i,
                       Stair& stair) {
  if (ramp != 0) return next_ramp_stair(accel_q62, n, ramp, i, stair);
  stair = {accel_q62, n};
  return i == 0;
}

/// Acceleration of the straight ramp that stair i of a phase with ramps approximates, `ticks_left`
/// ticks before the stair ends.
std::int64_t straight_ramp_q62(std::int64_t accel_q62, std::uint32_t n, std::uint8_t ramp,
                               std::uint32_t i, std::uint32_t ticks_left);

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
  std::uint8_t lead_ramp = 0;         ///< see ramp_of(); accelerations are those between the ramps
  std::uint8_t tail_ramp = 0;

  constexpr std::uint32_t ticks() const { return lead_ticks + cruise_ticks + tail_ticks; }
  constexpr bool is_at_rest() const {
    return speed_q62 == 0 && lead_accel_q62 == 0 && tail_accel_q62 == 0;
  }
  std::int64_t cruise_speed_q62() const {
    return speed_q62 +
           lead_accel_q62 * static_cast<std::int64_t>(full_ticks(lead_ticks, lead_ramp));
  }
  std::int64_t end_speed_q62() const {
    return cruise_speed_q62() +
           tail_accel_q62 * static_cast<std::int64_t>(full_ticks(tail_ticks, tail_ramp));
  }
};

/// Displacement of n ticks from speed v with (even) acceleration A, Q62 (exact).
constexpr Int128 displacement_q62(std::int64_t speed_q62, std::int64_t accel_q62, std::uint32_t n) {
  if (n == 0) return {};
  // n (v + n A / 2): the sum is the mean speed of the phase.
  if (n >> 16 == 0) return Int128::short_product(speed_q62 + short_product(accel_q62 / 2, n), n);
  if (accel_q62 == 0) return Int128::product(speed_q62, n);
  const auto square = static_cast<std::int64_t>(wide_product(n, n));
  return Int128::product(speed_q62, n) + Int128::product(accel_q62 / 2, square);
}

/// The same for a phase that has ramps.
Int128 ramp_displacement_q62(std::int64_t speed_q62, std::int64_t accel_q62, std::uint32_t n,
                             std::uint8_t ramp);
/// The same for any phase.
inline Int128 displacement_q62(std::int64_t speed_q62, std::int64_t accel_q62, std::uint32_t n,
                               std::uint8_t ramp) {
  return ramp == 0 ? displacement_q62(speed_q62, accel_q62, n)
                   : ramp_displacement_q62(speed_q62, accel_q62, n, ramp);
}

/// Displacement of a whole profile, Q62 (exact).
inline Int128 displacement_q62(const AxisProfile& p) {
  const std::int64_t cruise = p.cruise_speed_q62();
  return displacement_q62(p.speed_q62, p.lead_accel_q62, p.lead_ticks, p.lead_ramp) +
         displacement_q62(cruise, 0, p.cruise_ticks) +
         displacement_q62(cruise, p.tail_accel_q62, p.tail_ticks, p.tail_ramp);
}

/// Position, in steps with a Q64 fraction, and speed of an axis.
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

/// Position of the middle of a step, where an axis rests at an integer point.
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

/// The power of a continuous laser during a segment, 65535 = full (segment_power.hpp). No default
/// values: it is a member of a union.
struct SegmentPower {
  std::uint16_t start, cruise;
  std::uint32_t lead_slope_q16, tail_slope_q16;  ///< per tick, modulo 2^32
};

/// How the laser of a segment that shines is controlled.
enum class BeamKind : std::uint8_t {
  even,             ///< by SegmentPower
  pixels,           ///< each cell has its power
  pixels_by_speed,  ///< the same times actual over programmed speed
  pulses,           ///< a pulse at every edge of a cell
  at_rest           ///< by SegmentPower, while no axis moves: a dwell with light
};

/// Fraction bits of the position, in cells, where a segment begins. The upper bits are the number
/// of the cell, of pulses its lower bits only.
inline constexpr int pixel_place_bits = 16, pulse_place_bits = 24;

/// Ticks that a cell takes at the feed rate, as a floating-point number of 16 bits: a mantissa of
/// 12 bits, of which the highest one, always set, is not stored; always above 0.
class CellTicks {
 public:
  static constexpr int mantissa_bits = 11, max_exponent = 31;
  constexpr explicit CellTicks(std::uint16_t bits) : bits_(bits) {}
  /// mantissa() 2^(exponent() - mantissa_bits), the mantissa with its highest bit.
  static constexpr std::uint16_t of(std::uint32_t mantissa, int exponent) {
    return static_cast<std::uint16_t>(exponent << mantissa_bits |
                                      static_cast<int>(mantissa & ((1u << mantissa_bits) - 1)));
  }
  constexpr std::uint32_t mantissa() const {
    return 1u << mantissa_bits | (bits_ & ((1u << mantissa_bits) - 1));
  }
  /// The exponent of 2 for the mantissa as a whole number.
  constexpr int exponent() const { return (bits_ >> mantissa_bits) - mantissa_bits; }

 private:
  std::uint16_t bits_;
};

/// The cells of a segment. No default values: it is a member of a union.
struct SegmentBeam {
  std::uint32_t place;  ///< start of the segment, cells
  /// cells per step: a mantissa of 24 bits above the number of its fraction bits
  std::uint32_t ratio;
  std::uint16_t list;  ///< of pixels: PowerTable
  union {
    std::uint16_t cell_ticks;  ///< of pixels by speed: CellTicks
    std::uint16_t power;       ///< of pulses, 65535 = full
  };
};

/// Motion of all axes from one beat, or one position on a path, to a later one.
struct Segment {
  std::uint64_t start_tick = 0;
  std::uint32_t ticks = 0;
  BeatReason reason = BeatReason::moving;  ///< of the beats that pass inside
  bool ends_point : 1 = false;             ///< the end is a target of the job
  bool shines : 1 = false;                 ///< a continuous laser, in at least a part of it
  bool beam_begins : 1 = false;  ///< of pulses: they do not continue those of the previous segment
  std::uint8_t beam_axis : 2 = 0;       ///< cells are counted in steps of this axis
  BeamKind beam_kind = BeamKind::even;  ///< if it shines
  std::uint8_t changes = 0;  ///< mark of output changes due at its start (change_queue.hpp)
  std::uint32_t point = 0;   ///< index of that target
  union {
    SegmentShot shot{};
    SegmentPower power;  ///< instead of a shot, if it shines
    SegmentBeam beam;    ///< if it shines and has cells
  };
  PerAxis<AxisProfile> axis{};
  MotionState end;  ///< state after the last tick: where the next segment starts

  std::uint64_t end_tick() const { return start_tick + ticks; }
  bool has_shot() const { return !shines && shot.present; }
};
/// The board keeps more than a hundred of them in its SRAM.
static_assert(sizeof(Segment) <= 328);

}  // namespace lamplock::stepper
