#include "firmware/motion/profile/limits.hpp"

#include <limits>

#include "firmware/motion/profile/reach.hpp"
#include "shared/pulse_times.hpp"
#include "shared/work_space.hpp"

namespace lamplock::motion {
namespace {

using settings::Id;

/// Minimum beat, so that the margins below make sense.
constexpr std::uint32_t min_beat_ticks = 100;
/// Maximum error of the speeds of a way in units of the search, times four: 32.
constexpr int search_share_bits = 5;
/// Highest speed of an axis that leaves time for its pulses.
std::int64_t max_speed_q62(const settings::Values& values) {
  const std::uint32_t divisor = 100u * pulse_times(values).period_ticks;
  return Int128::product(one_q62, max_step_percent).divided_by(divisor).to_int64() + 1;
}
/// About 0.2 step/s2; below it the reciprocal would lose its precision.
constexpr std::int64_t min_accel_q62 = std::int64_t{1} << 20;
/// About 0.03 step/s3.
constexpr std::int64_t min_jerk_q78 = std::int64_t{1} << 13;
/// Default shot tolerance, the larger of the two: half a step, 5 um.
constexpr std::int64_t half_step_q32 = one_q32 / 2;
constexpr std::int32_t default_tolerance_milli_um = 5000;

/// mm/min times step/mm, both in thousandths, to steps per tick: / 10^6 / 60 / 10^6.
std::int64_t speed_per_tick_q62(std::int32_t rate_milli, std::int32_t steps_milli) {
  // 6 * 10^13 = 2^14 * 3662109375
  const Int128 speed =
      (Int128::product(rate_milli, steps_milli) << (62 - 14)).divided_by(3662109375u);
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();  // 2 steps per tick
  return speed > Int128(most) ? most : speed.to_int64();
}

/// mm/s2 times step/mm, both in thousandths, to steps per tick squared: / 10^6 / 10^12.
std::int64_t accel_per_tick_q62(std::int32_t accel_milli, std::int32_t steps_milli) {
  // 10^18 = 2^18 * 1953125^2
  return (Int128::product(accel_milli, steps_milli) << (62 - 18))
      .divided_by(1953125u)
      .divided_by(1953125u)
      .to_int64();
}

/// m/s3 times step/mm, both in thousandths, to steps per tick cubed: / 10^3 / 10^18.
std::int64_t jerk_per_tick_q78(std::int32_t jerk_milli, std::int32_t steps_milli) {
  // 10^21 = 2^21 * 5^10 * 5^11
  return (Int128::product(jerk_milli, steps_milli) << (78 - 21))
      .divided_by(9765625u)
      .divided_by(48828125u)
      .to_int64();
}

/// a / b for b > 0, rounded up, the divisor to 32 bits.
std::int64_t ratio_up(Int128 a, std::int64_t b) {
  int shift = 0;
  for (; b >> shift > 0xffffffff; ++shift) {
  }
  return (a >> shift).divided_by(static_cast<std::uint32_t>(b >> shift)).to_int64() + 1;
}

/// Ramps are found to 1/256 of their phase: a pulse may peak higher by this part.
constexpr int ramp_rounding = 64;
/// Maximum loss of a pulse by rounding to stairs, ticks.
constexpr std::uint32_t stair_rounding = 16;

/// Planning uses the mean acceleration of pulses of this length, the longest of: nearly half a
/// beat, so that most ways of one beat are feasible; the time in which the jerk reaches the
/// acceleration, for ways of many beats; and this. Found by measuring beats per point on walks.
constexpr std::int64_t min_pulse_ticks = 2 * stepper::min_stair_ticks;
constexpr std::int64_t pulse_ticks(std::uint32_t beat, std::int64_t rise_ticks) {
  const std::int64_t half_beat = beat / 64 * 29;
  const std::int64_t longer = half_beat > rise_ticks ? half_beat : rise_ticks;
  return longer > min_pulse_ticks ? longer : min_pulse_ticks;
}

/// A slower rise, four minutes, is not a limit but a mistake.
constexpr std::int64_t max_rise_ticks = std::int64_t{1} << 28;

/// Acceleration left after rounding (see set_plan_limits).
std::int64_t steady_accel_q62(std::int64_t accel_q62, std::uint32_t beat) {
  const std::uint32_t margin = beat * 10;
  return mul_div(accel_q62, margin - 13, margin) - 1;
}

/// A pulse over n ticks (segment.hpp) with peak A and jerk J has the mean acceleration A (1 - A /
/// (J n)) or, if it is too short to reach A, J n / 4. False if that is too little.
bool set_jerk_limits(AxisLimits& axis, std::uint32_t beat) {
  const std::int64_t most = pulse_peak_q62(axis, beat);
  const auto rise = [&axis](std::int64_t accel_q62) {
    return ratio_up(Int128(accel_q62) << 16, axis.jerk_q78);
  };
  if (axis.jerk_q78 < min_jerk_q78 || rise(most) > max_rise_ticks) return false;
  axis.rise_ticks = stair_rounding;
  axis.brake_accel_q62 = axis.plan_accel_q62 = most;
  if (rise(most) <= flat_rise_ticks) return most >= min_accel_q62;
  // Ramps are at least a stair long: as if the jerk were no higher than this.
  const std::int64_t softest = (Int128(most) << 16).divided_by(stepper::min_stair_ticks).to_int64();
  const std::int64_t jerk_q78 = axis.jerk_q78 < softest ? axis.jerk_q78 : softest;
  const std::int64_t n = pulse_ticks(beat, rise(most)) - stair_rounding;
  const Int128 product = Int128::product(jerk_q78, n) >> 16;
  constexpr std::int64_t largest = std::int64_t{1} << 62;
  const std::int64_t jn = product > Int128(largest) ? largest : product.to_int64();
  axis.plan_accel_q62 = jn / 2 < most ? jn / 4 : most - ratio_up(Int128::product(most, most), jn);
  const std::int64_t flat = (Int128::product(axis.jerk_q78, flat_rise_ticks) >> 16).to_int64();
  if (axis.plan_accel_q62 < flat) axis.plan_accel_q62 = flat;
  axis.brake_accel_q62 = most < 2 * axis.plan_accel_q62 ? most : 2 * axis.plan_accel_q62;
  const auto ramp = static_cast<std::uint32_t>(rise(axis.brake_accel_q62));
  axis.rise_ticks += ramp > stepper::min_stair_ticks ? ramp : stepper::min_stair_ticks;
  return axis.plan_accel_q62 >= min_accel_q62;
}

/// Reciprocal of the acceleration per beat squared as mantissa and shift.
void set_reciprocal(AxisLimits& axis, std::uint32_t beat) {
  Int128 accel = Int128::product(axis.plan_accel_q62, std::int64_t{beat} * beat);
  int shift = 0;
  while (accel >= Int128(std::int64_t{1} << 32)) {
    accel = accel >> 1;
    ++shift;
  }
  while (accel < Int128(std::int64_t{1} << 31)) {
    accel = accel << 1;
    --shift;
  }
  const std::uint64_t mantissa = accel.lo();  // acceleration = mantissa * 2^shift / 2^62
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the loops leave at least 2^31
  const std::uint64_t inverse = (std::uint64_t{1} << 63) / mantissa;
  axis.per_accel = static_cast<std::uint32_t>(inverse > 0xffffffffu ? 0xffffffffu : inverse);
  axis.per_accel_shift = 1 + shift;
}

/// V/A in beats, limited to the range of reach.hpp.
std::int64_t normalised_speed_q32(const AxisLimits& axis, std::uint32_t beat) {
  constexpr std::int64_t largest = std::int64_t{max_beats_per_point} << 32;
  const std::int64_t steps_per_beat_q32 =
      (Int128::product(axis.plan_speed_q62, beat) >> 30).to_int64();
  const std::int64_t v = axis.displacement_q32(steps_per_beat_q32);
  return v < largest ? v : largest;
}

/// Programmed speed jump, mm/s times step/mm, both in thousandths: / 10^6 / 10^6. Limited to the
/// highest speed: then an axis that turns at once has half of it, and steps that wait catch up.
std::int64_t jump_per_tick_q62(std::int32_t jump_milli, std::int32_t steps_milli,
                               std::int64_t max_q62) {
  // 10^12 = 2^12 * 244140625
  const Int128 jump =
      (Int128::product(jump_milli, steps_milli) << (62 - 12)).divided_by(244140625u);
  return jump > Int128(max_q62) ? max_q62 : jump.to_int64();
}

/// Steps/mm of the coarsest axis over those of this one: makes steps of all axes comparable.
std::uint32_t weight_q31(const settings::Values& values, int axes, int a) {
  std::int32_t coarsest = values.milli(Id::steps_per_mm_x);
  for (int other = 1; other < axes; ++other) {
    const std::int32_t steps_milli = values.milli(Id::steps_per_mm_x, other);
    if (steps_milli < coarsest) coarsest = steps_milli;
  }
  const auto own = static_cast<std::uint64_t>(values.milli(Id::steps_per_mm_x, a));
  return static_cast<std::uint32_t>((static_cast<std::uint64_t>(coarsest) << 31) / own);
}

/// Maximum distance of the axis from its point at a shot, steps.
std::int64_t shot_tolerance_q32(const settings::Values& values, int a) {
  const std::int32_t set = values.milli(Id::shot_tolerance);
  const std::int32_t milli_um = set != 0 ? set : default_tolerance_milli_um;
  const std::int64_t steps_q32 =
      (Int128::product(milli_um, values.milli(Id::steps_per_mm_x, a)) << 32)
          .divided_by(1'000'000'000u)
          .to_int64();
  return set == 0 && steps_q32 < half_step_q32 ? half_step_q32 : steps_q32;
}

/// The planning limits in the units of the search.
void normalise(AxisLimits& axis, std::uint32_t beat) {
  set_reciprocal(axis, beat);
  axis.speed_q32 = normalised_speed_q32(axis, beat);
  axis.scale = make_scale(axis.speed_q32);
}

/// Speed and acceleration of an axis for this length of a tick; false if the speed is zero or, at
/// the nominal length, too high. In longer ticks the steps per tick do not rise above the limit.
bool set_limits(AxisLimits& axis, const settings::Values& values, int a, std::uint32_t tick_q16) {
  const std::int32_t steps_milli = values.milli(Id::steps_per_mm_x, a);
  const std::int64_t q16 = tick_q16;
  const std::int64_t max_q62 = max_speed_q62(values);
  const std::int64_t nominal_q62 = speed_per_tick_q62(values.milli(Id::max_rate_x, a), steps_milli);
  const std::int64_t speed_q62 = mul_div(nominal_q62, q16, 65536);
  axis.speed_q62 = speed_q62 < max_q62 ? speed_q62 : max_q62;
  axis.accel_q62 = mul_div(
      mul_div(accel_per_tick_q62(values.milli(Id::acceleration_x, a), steps_milli), q16, 65536),
      q16, 65536);
  axis.jerk_q78 = jerk_per_tick_q78(values.milli(Id::jerk_x, a), steps_milli);
  for (int power = 0; power < 3; ++power) axis.jerk_q78 = mul_div(axis.jerk_q78, q16, 65536);
  const std::int64_t jump_q62 =
      jump_per_tick_q62(values.milli(Id::speed_jump_x, a), steps_milli, max_q62);
  axis.jump_q62 = mul_div(jump_q62, q16, 65536);
  return nominal_q62 <= max_q62 && axis.speed_q62 > 0;
}

/// Sets the planning limits. Rounding switch points to whole ticks costs at most 1.02/n of the
/// acceleration and 4.8/n of the speed over n ticks (measured; a segment has at least one beat),
/// rounding of the search about 0.02/n to 0.2/n of the acceleration (scaled_reach.hpp; the slower
/// the axis, the more).
void set_plan_limits(AxisLimits& axis, std::uint32_t beat) {
  const std::uint32_t margin = beat * 10;
  axis.plan_accel_q62 = steady_accel_q62(axis.accel_q62, beat);
  axis.plan_speed_q62 = mul_div(axis.speed_q62, margin - 50, margin) - 1;
  axis.brake_accel_q62 = axis.plan_accel_q62;
  axis.rise_ticks = 0;
}

/// Makes the limits of one axis; returns the first axis' row of the offending setting, or none.
Id make_axis(AxisLimits& axis, const settings::Values& values, int a, std::uint32_t beat,
             std::uint32_t tick_q16) {
  if (!set_limits(axis, values, a, tick_q16)) return Id::max_rate_x;
  set_plan_limits(axis, beat);
  if (values.milli(Id::jerk_x, a) != 0 && !set_jerk_limits(axis, beat)) return Id::jerk_x;
  if (axis.plan_accel_q62 < min_accel_q62 || axis.plan_speed_q62 <= 0) return Id::acceleration_x;
  normalise(axis, beat);
  // A speed error of some units of the search costs four times as much of the acceleration in a way
  // of one beat: it matters where V/A is seconds.
  axis.plan_accel_q62 -= axis.plan_accel_q62 >> (axis.scale.bits - search_share_bits);
  normalise(axis, beat);
  axis.shot_tolerance_q32 = shot_tolerance_q32(values, a);
  axis.shot_way_q32 = axis.displacement_q32(axis.shot_tolerance_q32);
  return Id::count;
}

/// True if jerk is limited on any axis of Limits or BrakeLimits.
template <typename AllAxes>
bool any_jerk(const AllAxes& limits) {
  for (int a = 0; a < limits.axes; ++a)
    if (limits.axis[static_cast<std::size_t>(a)].jerk_q78 != 0) return true;
  return false;
}

}  // namespace

AxisBrake::AxisBrake(const AxisLimits& axis)
    : accel_q62(axis.brake_accel_q62),
      jerk_q78(axis.jerk_q78),
      rise_ticks(axis.rise_ticks),
      min_steps(axis.min_steps),
      max_steps(axis.max_steps) {}

BrakeLimits::BrakeLimits(const Limits& limits) : axes(limits.axes) {
  for (std::size_t a = 0; a < axis.size(); ++a) axis[a] = AxisBrake(limits.axis[a]);
}

bool Limits::jerk_limited() const { return any_jerk(*this); }
bool BrakeLimits::jerk_limited() const { return any_jerk(*this); }

std::int64_t pulse_peak_q62(const AxisLimits& axis, std::uint32_t beat) {
  const std::int64_t steady = steady_accel_q62(axis.accel_q62, beat);
  return steady - steady / ramp_rounding;
}

Result make_limits(const settings::Values& values, std::uint32_t beat, std::uint32_t tick_q16,
                   Limits& out, std::uint16_t& setting) {
  out.axes = values.whole(Id::axes);
  out.beat_ticks = beat;
  if (beat < min_beat_ticks) {
    setting = settings::number(Id::lamp_frequency);
    return Result::bad_value;
  }
  // A shot that is not over at the next flash would hide its edge, and its arm window would be
  // before the segment that ends with it.
  const std::int64_t shot_ns =
      std::int64_t{values.milli(Id::q_switch_delay)} + values.milli(Id::q_switch_width);
  if (shot_ns >= std::int64_t{beat} * tick_ns) {
    setting = settings::number(Id::q_switch_width);
    return Result::bad_value;
  }
  const StepLimits space = work_space(values);
  for (int a = 0; a < out.axes; ++a) {
    AxisLimits& axis = out.axis[static_cast<std::size_t>(a)];
    axis.min_steps = space.min[static_cast<std::size_t>(a)];
    axis.max_steps = space.max[static_cast<std::size_t>(a)];
    axis.weight_q31 = weight_q31(values, out.axes, a);
    if (const Id bad = make_axis(axis, values, a, beat, tick_q16); bad != Id::count) {
      setting = settings::number(settings::for_axis(bad, a));
      return Result::bad_value;
    }
  }
  return Result::ok;
}

}  // namespace lamplock::motion
