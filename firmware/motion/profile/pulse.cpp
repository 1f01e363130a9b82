#include "firmware/motion/profile/pulse.hpp"

#include <array>

#include "firmware/motion/profile/reach.hpp"

namespace lamplock::motion {
namespace {

using stepper::falling_ramp;
using stepper::full_ticks;
using stepper::max_ramp;
using stepper::min_stair_ticks;
using stepper::pulse_accel_unit;
using stepper::ramp_of;

/// Maximum number of times that a brake is lengthened by an eighth; the first try is long enough.
constexpr int max_tries = 32;

/// Share of a braking distance reserved for rounding: 1/32.
constexpr int brake_share_bits = 5;

/// The largest acceleration of a pulse up to `accel`.
std::int64_t whole_units(std::int64_t accel) { return accel / pulse_accel_unit * pulse_accel_unit; }

/// Change of speed by a pulse of n ticks with ramps of r ticks at the jerk: J r (n - r).
bool suffices(std::uint8_t ramp, std::uint32_t n, std::int64_t change, std::int64_t jerk_q78) {
  const std::uint32_t r = ramp_of(n, ramp).ticks();
  const auto ticks = static_cast<std::int64_t>(wide_product(r, n - r));
  return Int128::product(jerk_q78, ticks) >= Int128(change) << 16;
}

/// An acceleration may begin and end at once if the jerk gives it in half of the shortest stair.
bool may_be_flat(std::int64_t accel, std::int64_t jerk_q78) {
  return Int128::product(jerk_q78, flat_rise_ticks) >= Int128(abs64(accel)) << 16;
}

/// The shortest ramp, at least a stair if the phase is long enough; 0 if there is none.
std::uint8_t min_ramp(std::uint32_t n, std::int64_t change, std::int64_t jerk_q78) {
  if (!suffices(max_ramp, n, change, jerk_q78)) return 0;
  const auto stair = (min_stair_ticks * (2 * max_ramp) + n - 1) / n;
  std::uint8_t ramp = max_ramp;
  for (std::uint8_t part = max_ramp / 2; part != 0; part /= 2) {
    const auto shorter = static_cast<std::uint8_t>(ramp - part);
    if (shorter >= stair && suffices(shorter, n, change, jerk_q78)) ramp = shorter;
  }
  return ramp;
}

/// The acceleration with which a phase of n ticks makes this change of speed.
std::int64_t pulse_accel(std::int64_t change, std::uint32_t n, std::uint8_t ramp) {
  return n == 0 ? 0 : whole_units(change / static_cast<std::int64_t>(full_ticks(n, ramp)));
}

/// The ramp that such a phase needs, 0 = none; false if no ramp is long enough.
bool find_ramp(std::int64_t change, std::uint32_t n, std::int64_t jerk_q78, std::uint8_t& ramp) {
  ramp = 0;
  if (jerk_q78 == 0 || may_be_flat(pulse_accel(change, n, 0), jerk_q78)) return true;
  ramp = min_ramp(n, abs64(change), jerk_q78);
  return ramp != 0;
}

/// Both. An impossible pulse is left too steep, so that it is recognised.
bool make_pulse(std::int64_t change, std::uint32_t n, std::int64_t jerk_q78, std::int64_t& accel,
                std::uint8_t& ramp) {
  const bool found = find_ramp(change, n, jerk_q78, ramp);
  accel = pulse_accel(change, n, ramp);
  return found;
}

bool keeps_jerk(std::int64_t accel, std::uint32_t n, std::uint8_t ramp, std::int64_t jerk_q78) {
  if (ramp == 0) return may_be_flat(accel, jerk_q78);
  const std::uint32_t r = ramp_of(n, ramp).ticks();
  return Int128::product(jerk_q78, r) >= Int128(abs64(accel)) << 16;
}

/// Appends a brake to a profile: its tail.
void add_brake(AxisProfile& p, const AxisBrake& axis) {
  const std::int64_t v = p.cruise_speed_q62();
  std::uint32_t n = brake_ticks(v, axis);
  for (int tries = 0; tries < max_tries; ++tries, n += n / 8) {
    p.tail_ticks = n;
    if (make_pulse(-v, n, axis.jerk_q78, p.tail_accel_q62, p.tail_ramp)) return;
  }
}

/// Ticks in which the jerk reduces an acceleration to zero, whole stairs.
std::uint32_t fall_ticks(std::int64_t accel, std::int64_t jerk_q78) {
  std::int64_t jerk = jerk_q78;
  int shift = 0;
  for (; jerk > 0xffffffff; ++shift) jerk >>= 1;
  const std::uint64_t ticks =
      ((Int128(abs64(accel)) << 16) >> shift).divided_by(static_cast<std::uint32_t>(jerk)).lo();
  constexpr std::uint32_t stairs = 1u << stepper::max_log_stairs;
  const std::uint64_t least = ticks < min_stair_ticks ? min_stair_ticks : ticks;
  return (static_cast<std::uint32_t>(least) / stairs + 1) * stairs;
}

/// A brake in progress: its acceleration is constant for `stay` ticks, and then falls.
AxisProfile extended_brake(std::int64_t v0, std::uint32_t stay, std::uint32_t fall) {
  AxisProfile p;
  p.speed_q62 = v0;
  p.lead_ticks = stay;
  p.tail_ticks = fall;
  p.tail_ramp = falling_ramp;
  // The fall changes the speed like half of its time at the previous acceleration.
  const std::uint32_t full = stay + fall / 2;
  p.lead_accel_q62 = p.tail_accel_q62 = whole_units(-v0 / static_cast<std::int64_t>(full));
  return p;
}

/// A brake from a speed and an acceleration. Its acceleration falls first; or last, where the axis
/// already brakes and stops sooner that way.
AxisProfile make_jerk_brake(std::int64_t v0, std::int64_t accel, const AxisBrake& axis) {
  AxisProfile p;
  p.speed_q62 = v0;
  accel = whole_units(accel);
  if (accel != 0) {
    const std::uint32_t fall = fall_ticks(accel, axis.jerk_q78);
    p.lead_accel_q62 = accel;
    p.lead_ticks = fall;
    p.lead_ramp = falling_ramp;
    const std::int64_t after = p.cruise_speed_q62();
    if (v0 != 0 && (v0 < 0) != (accel < 0) && (after == 0 || (after < 0) == (v0 < 0))) {
      const AxisProfile held = extended_brake(v0, braking_ticks(after, abs64(accel)), fall);
      if (after == 0) return held;
      add_brake(p, axis);
      set_turns(p);
      return p.ticks() < held.ticks() ? p : held;
    }
  }
  add_brake(p, axis);
  set_turns(p);
  return p;
}

}  // namespace

bool make_pulses(AxisProfile& p, std::int64_t v1, std::int64_t jerk_q78) {
  const std::int64_t change = p.cruise_speed_q62() - p.speed_q62;
  const bool lead = make_pulse(change, p.lead_ticks, jerk_q78, p.lead_accel_q62, p.lead_ramp);
  const bool tail =
      make_pulse(v1 - p.cruise_speed_q62(), p.tail_ticks, jerk_q78, p.tail_accel_q62, p.tail_ramp);
  set_turns(p);
  return lead && tail;
}

bool make_pulses(PerAxis<AxisProfile>& profiles, const PerAxis<std::int64_t>& v1,
                 const Limits& limits) {
  std::uint8_t lead = 0, tail = 0;
  for (int a = 0; a < limits.axes; ++a) {
    const AxisProfile& p = profiles[index(a)];
    const std::int64_t jerk_q78 = limits.axis[index(a)].jerk_q78, vc = p.cruise_speed_q62();
    std::uint8_t first = 0, last = 0;
    if (!find_ramp(vc - p.speed_q62, p.lead_ticks, jerk_q78, first)) return false;
    if (!find_ramp(v1[index(a)] - vc, p.tail_ticks, jerk_q78, last)) return false;
    if (first > lead) lead = first;
    if (last > tail) tail = last;
  }
  for (int a = 0; a < limits.axes; ++a) {
    AxisProfile& p = profiles[index(a)];
    p.lead_accel_q62 = pulse_accel(p.cruise_speed_q62() - p.speed_q62, p.lead_ticks, lead);
    p.lead_ramp = lead;
    p.tail_accel_q62 = pulse_accel(v1[index(a)] - p.cruise_speed_q62(), p.tail_ticks, tail);
    p.tail_ramp = tail;
    set_turns(p);
  }
  return true;
}

bool keeps_jerk(const AxisProfile& p, std::int64_t jerk_q78) {
  return jerk_q78 == 0 || (keeps_jerk(p.lead_accel_q62, p.lead_ticks, p.lead_ramp, jerk_q78) &&
                           keeps_jerk(p.tail_accel_q62, p.tail_ticks, p.tail_ramp, jerk_q78));
}

AxisProfile make_choice(std::uint32_t choice, Int128 distance, std::int64_t v0, std::int64_t v1,
                        std::uint32_t ticks) {
  struct Eighths {
    std::uint8_t lead, tail;
  };
  static constexpr std::array<Eighths, phase_choices> choices{
      {{4, 4}, {5, 3}, {3, 5}, {6, 2}, {2, 6}, {3, 3}, {4, 2}, {2, 4}, {2, 2}, {1, 1}}};
  const Eighths e = choices[choice];
  const auto part = [ticks](std::uint32_t eighths) {
    const auto n = static_cast<std::uint32_t>(wide_product(ticks, eighths) >> 3);
    return n < 1 ? 1 : n;
  };
  const std::uint32_t lead = part(e.lead),
                      tail = e.lead + e.tail == 8 ? ticks - lead : part(e.tail);
  return make_phases(distance, v0, v1, lead, ticks - lead - tail, tail);
}

std::uint32_t brake_ticks(std::int64_t v0, const AxisBrake& axis) {
  const std::uint32_t least = braking_ticks(v0, axis.accel_q62);
  if (axis.jerk_q78 == 0 || v0 == 0) return least;
  // With a ramp of A/J ticks it takes v/A + A/J, and less if v is small.
  const std::uint32_t n = least + axis.rise_ticks;
  return n + n / 64;
}

std::int32_t pulse_braking_speed_qs(const AxisLimits& axis, std::uint32_t beat_ticks,
                                    std::int64_t steps) {
  // Beats; with more the square below would exceed 64 bits.
  constexpr std::int64_t max_q32 = std::int64_t{1} << 46;
  const std::int64_t half_q32 = (std::int64_t{axis.rise_ticks} << 31) / beat_ticks;
  if (steps <= 0 || half_q32 >= max_q32) return 0;
  // Ramps of whole ticks and stairs are too long by less than this share.
  const std::int64_t all = axis.displacement_q32(steps << 32);
  const std::int64_t way = all - (all >> brake_share_bits);
  if (way >= max_displacement_q32) return axis.scale.limit_qs;
  const std::int64_t speed = sqrt_down_q32(mul_q32(half_q32, half_q32) + 2 * way) - half_q32;
  if (speed <= 0) return 0;
  return speed < axis.speed_q32 ? axis.scale.range().clamp(axis.scale.scaled(speed))
                                : axis.scale.limit_qs;
}

stepper::Segment make_brake(const stepper::MotionState& from, const BrakeLimits& limits,
                            const Accelerations& accel) {
  stepper::Segment s;
  s.start_tick = from.tick;
  s.ticks = 1;
  for (int a = 0; a < limits.axes; ++a) {
    const AxisBrake& axis = limits.axis[index(a)];
    const std::int64_t v = from.axis[index(a)].speed_q62;
    std::uint32_t n = braking_ticks(v, axis.accel_q62);
    if (axis.jerk_q78 != 0) {
      s.axis[index(a)] = make_jerk_brake(v, accel[index(a)], axis);
      n = s.axis[index(a)].ticks();
    }
    if (n > s.ticks) s.ticks = n;
  }
  s.end.tick = s.end_tick();
  for (int a = 0; a < max_axes; ++a) {
    const stepper::AxisState& axis = from.axis[index(a)];
    const AxisBrake& limit = limits.axis[index(a)];
    if (a < limits.axes && limit.jerk_q78 == 0)  // rests until all axes do
      s.axis[index(a)] = make_brake(axis.speed_q62, limit.accel_q62, s.ticks);
    s.end.axis[index(a)].position_q64 =
        axis.position_q64 + (stepper::displacement_q62(s.axis[index(a)]) << 2);
  }
  return s;
}

bool stays_inside(const stepper::Segment& s, const stepper::MotionState& from,
                  const BrakeLimits& limits) {
  for (int a = 0; a < limits.axes; ++a) {
    const AxisBrake& axis = limits.axis[index(a)];
    const Int128 start = from.axis[index(a)].position_q64;
    const Excursion e = excursion(s.axis[index(a)]);
    if ((start + (e.low_q62 << 2)).hi() < axis.min_steps ||
        (start + (e.high_q62 << 2)).hi() > axis.max_steps)
      return false;
  }
  return true;
}

}  // namespace lamplock::motion
