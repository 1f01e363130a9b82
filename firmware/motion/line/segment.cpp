#include "firmware/motion/line/segment.hpp"

#include "firmware/motion/profile/profile.hpp"
#include "firmware/motion/profile/pulse.hpp"

namespace lamplock::motion {
namespace {

/// Less than this is no displacement of an axis but rounding: 2^-21 step, Q62.
constexpr std::int64_t no_way_q62 = one_q62 >> 21;

std::uint64_t magnitude(std::int64_t v) { return static_cast<std::uint64_t>(abs64(v)); }
std::int64_t even(std::int64_t accel_q62) { return accel_q62 & ~std::int64_t{1}; }

/// Speed of an axis; `per_tick`: part of the line in a tick, times steps of a part.
std::int64_t axis_speed_q62(std::int64_t parts, UFloat per_tick) {
  const auto count = static_cast<std::uint32_t>(magnitude(parts));
  const std::uint64_t product = wide_product(count, per_tick.mantissa());
  const int shift = -62 - per_tick.exponent();
  const auto speed = static_cast<std::int64_t>(shift >= 64  ? 0
                                               : shift >= 0 ? product >> shift
                                                            : product << -shift);
  return parts < 0 ? -speed : speed;
}

Int128 way_left_q62(const stepper::MotionState& at, const LinePlace& target, std::size_t a) {
  return (position_of(target, a) - at.axis[a].position_q64) >> 2;
}

/// Speeds of an axis at the ends of phases.
struct AxisSpeeds {
  std::int64_t start_q62 = 0, cruise_q62 = 0, end_q62 = 0;
};

/// a n modulo 2^64 for n below 2^32.
std::int64_t wrapped_product(std::int64_t a, std::uint32_t n) {
  if (n >> 16 == 0) return short_product(a, n);
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) * n);
}

/// Quotient of the error, in 20 bits if it is small: then the remainder is below 2^-34 step.
std::int64_t per_part(std::int64_t missing, std::uint32_t parts) {
  constexpr int dropped = 12;
  const std::int64_t coarse = missing >> dropped;
  if (coarse == static_cast<std::int32_t>(coarse))
    return std::int64_t{static_cast<std::int32_t>(coarse) / static_cast<std::int32_t>(parts)} *
           (1 << dropped);
  return missing / static_cast<std::int64_t>(parts);
}

/// Adjusts the speed between the phases to make the distance exact: solved for the error, which is
/// much less than a step, so it is computed modulo two steps.
void fit_way(AxisSpeeds& v, std::int64_t way_q62, const LineRun& run) {
  const std::uint32_t parts = run.lead_ticks + 2 * run.cruise_ticks + run.tail_ticks;
  auto missing = static_cast<std::uint64_t>(way_q62) * 2 -
                 static_cast<std::uint64_t>(wrapped_product(v.cruise_q62, parts));
  if (run.lead_ticks != 0)
    missing -= static_cast<std::uint64_t>(wrapped_product(v.start_q62, run.lead_ticks));
  if (run.tail_ticks != 0)
    missing -= static_cast<std::uint64_t>(wrapped_product(v.end_q62, run.tail_ticks));
  v.cruise_q62 += per_part(static_cast<std::int64_t>(missing), parts);
  if (run.lead_ticks == 0) v.start_q62 = v.cruise_q62;
  if (run.tail_ticks == 0) v.end_q62 = v.cruise_q62;
}

void make_axis(const AxisSpeeds& v, const LineRun& run, AxisProfile& p) {
  p.speed_q62 = v.start_q62;
  p.lead_accel_q62 = p.tail_accel_q62 = 0;
  p.lead_ticks = run.lead_ticks;
  p.cruise_ticks = run.cruise_ticks;
  p.tail_ticks = run.tail_ticks;
  p.lead_turn_ticks = p.tail_turn_ticks = 0;
  p.lead_ramp = p.tail_ramp = 0;
  if (run.lead_ticks != 0)
    p.lead_accel_q62 =
        even((v.cruise_q62 - v.start_q62) / static_cast<std::int64_t>(run.lead_ticks));
  if (run.tail_ticks != 0)
    p.tail_accel_q62 =
        even((v.end_q62 - p.cruise_speed_q62()) / static_cast<std::int64_t>(run.tail_ticks));
  if (p.lead_accel_q62 != 0 || p.tail_accel_q62 != 0) set_turns(p);
}

void set_rest(std::uint32_t ticks, AxisProfile& p) {
  LineRun run;
  run.cruise_ticks = ticks;
  make_axis({}, run, p);
}

/// Displacement, Q62.
Int128 way_of(const AxisProfile& p) {
  if (p.lead_ticks + p.tail_ticks == 0) return Int128::times(p.speed_q62, p.cruise_ticks);
  return stepper::displacement_q62(p);
}

}  // namespace

UFloat length_left(const LineWay& way, UFloat length, int longest, const stepper::MotionState& at) {
  const std::size_t a = index(longest);
  Int128 left = position_of(way.target, a) - at.axis[a].position_q64;
  if (way.way.parts[a] < 0) left = -left;
  if (left.negative()) return {};
  const auto hi = static_cast<std::uint64_t>(left.hi());
  const UFloat steps = hi == 0 ? UFloat(left.lo(), -64) : UFloat(hi << 32 | left.lo() >> 32, -32);
  const auto parts = static_cast<std::uint32_t>(magnitude(way.way.parts[a]));
  return times_power(steps * length / UFloat(parts), way.way.bits);
}

void make_segment(const stepper::MotionState& from, const LineWay& way, const LineRun& run,
                  const Limits& limits, bool pulses, stepper::Segment& s) {
  s.start_tick = from.tick;
  s.ticks = run.ticks();
  s.reason = BeatReason::moving;
  s.shot = {};
  s.end.tick = s.end_tick();
  const bool steady = run.lead_ticks + run.tail_ticks == 0;
  const bool fits = run.whole && !is_zero(run.cruise);
  const UFloat cruise = run.cruise * way.per_length;
  const UFloat start = steady ? cruise : run.start * way.per_length;
  const UFloat end = steady ? cruise : run.end * way.per_length;
  PerAxis<std::int64_t> ends{};
  for (std::size_t a = 0; a < max_axes; ++a) {
    const std::int64_t parts = way.way.parts[a];
    AxisSpeeds v;
    if (parts == 0 && !pulses) {
      set_rest(s.ticks, s.axis[a]);
      continue;
    }
    if (parts != 0) {
      v.cruise_q62 = axis_speed_q62(parts, cruise);
      v.start_q62 = steady ? v.cruise_q62 : axis_speed_q62(parts, start);
      v.end_q62 = steady ? v.cruise_q62 : axis_speed_q62(parts, end);
      if (fits) fit_way(v, way_left_q62(from, way.target, a).to_int64(), run);
    }
    make_axis(v, run, s.axis[a]);
    ends[a] = v.end_q62;
  }
  if (pulses) make_pulses(s.axis, ends, limits);
  for (std::size_t a = 0; a < max_axes; ++a) {
    stepper::AxisState& axis = s.end.axis[a];
    axis.position_q64 = from.axis[a].position_q64;
    if (way.way.parts[a] != 0) axis.position_q64 = axis.position_q64 + (way_of(s.axis[a]) << 2);
    axis.speed_q62 = ends[a];
  }
}

stepper::Segment make_settling(const stepper::MotionState& from, std::uint32_t ticks) {
  stepper::Segment s;
  s.start_tick = from.tick;
  s.ticks = ticks;
  s.end = from;
  s.end.tick = s.end_tick();
  for (std::size_t a = 0; a < max_axes; ++a) {
    const Int128 position_q64 = from.axis[a].position_q64;
    const Int128 way = (stepper::middle_of_step(from.axis[a].step()) - position_q64) >> 2;
    s.axis[a].cruise_ticks = ticks;
    if (way < Int128(no_way_q62) && Int128(-no_way_q62) < way) continue;
    s.axis[a] = make_phases(way, 0, 0, ticks / 2, 0, ticks - ticks / 2);
    s.end.axis[a].position_q64 = position_q64 + (stepper::displacement_q62(s.axis[a]) << 2);
  }
  return s;
}

}  // namespace lamplock::motion
