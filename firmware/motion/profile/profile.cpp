#include "firmware/motion/profile/profile.hpp"

#include <bit>

namespace lamplock::motion {
namespace {

std::uint64_t magnitude(std::int64_t v) { return static_cast<std::uint64_t>(abs64(v)); }

/// Accelerations are even, see segment.hpp.
std::int64_t even(std::int64_t accel_q62) { return accel_q62 & ~std::int64_t{1}; }

/// Scales two magnitudes together until both are below 2^31, keeping their ratio.
void scale_down(std::uint64_t& a, std::uint64_t& b) {
  const auto width = static_cast<int>(std::bit_width(a | b));
  if (width <= 31) return;
  a >>= width - 31;
  b >>= width - 31;
}

/// Ticks before the rate v + (j + 1/2) A changes sign; 0 if it does not within the phase.
std::uint32_t turn_ticks(std::int64_t speed, std::int64_t accel, std::uint32_t ticks) {
  if (speed == 0 || accel == 0 || (speed < 0) == (accel < 0)) return 0;
  const std::int64_t a = abs64(accel);
  // Below 2^64: the product is the change of speed in the phase.
  if (magnitude(speed) + magnitude(a) / 2 >= magnitude(a) * ticks) return 0;
  const std::int64_t turn = (abs64(speed) + a / 2) / a;
  return static_cast<std::uint32_t>(turn);
}

/// The same for a whole phase whose speed only rises or only falls.
std::uint32_t turn_of_phase(std::int64_t speed, std::int64_t accel, std::uint32_t ticks,
                            std::uint8_t ramp) {
  if (ramp == 0) return turn_ticks(speed, accel, ticks);
  std::uint32_t before = 0;
  stepper::Stair stair;
  for (std::uint32_t i = stepper::first_stair(ramp);
       stepper::next_stair(accel, ticks, ramp, i, stair); ++i) {
    const std::uint32_t turn = turn_ticks(speed, stair.accel_q62, stair.ticks);
    if (turn != 0) return before + turn;
    speed += stair.accel_q62 * static_cast<std::int64_t>(stair.ticks);
    before += stair.ticks;
  }
  return 0;
}

/// a / b in Q32 for b > 0, the divisor to 31 bits.
std::int64_t ratio_q32(std::int64_t a, std::int64_t b) {
  const auto width = static_cast<int>(std::bit_width(magnitude(b)));
  const int shift = width > 31 ? width - 31 : 0;
  return ((Int128(a) << 32) >> shift).divided_by(static_cast<std::uint32_t>(b >> shift)).to_int64();
}

/// Maximum number of times that a ramp is lengthened by a part in a thousand.
constexpr int max_tries = 12;

/// Two phases without a limit can peak at several steps per tick, more than Q62 holds. One step per
/// tick is above every limit, so that a cruise replaces such a peak.
std::int64_t saturated(Int128 speed_q62) {
  if (speed_q62 > Int128(one_q62)) return one_q62;
  if (speed_q62 < Int128(-one_q62)) return -one_q62;
  return speed_q62.to_int64();
}

/// Phases with given lengths: the cruise speed follows from the displacement.
AxisProfile solve(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t lead,
                  std::uint32_t cruise, std::uint32_t tail) {
  // D = (v0 + vc) lead / 2 + vc cruise + (vc + v1) tail / 2, solved for vc.
  const Int128 numerator = (distance << 1) - Int128::times(v0, lead) - Int128::times(v1, tail);
  const std::int64_t vc = saturated(numerator.divided_by(lead + 2 * cruise + tail));
  AxisProfile p;
  p.speed_q62 = v0;
  p.lead_ticks = lead;
  p.cruise_ticks = cruise;
  p.tail_ticks = tail;
  p.lead_accel_q62 = even((vc - v0) / static_cast<std::int64_t>(lead));
  p.tail_accel_q62 = even((v1 - p.cruise_speed_q62()) / static_cast<std::int64_t>(tail));
  return p;
}

std::int64_t peak_accel(const AxisProfile& p) {
  const std::int64_t lead = abs64(p.lead_accel_q62), tail = abs64(p.tail_accel_q62);
  return lead > tail ? lead : tail;
}

/// Two phases: the switch point from the equation in the header, rounded down or up, whichever is
/// quieter.
AxisProfile two_phases(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t n) {
  const std::int64_t mean = distance.divided_by(n).to_int64();
  const std::int64_t excess = mean - v0 / 2 - v1 / 2;  // e / t
  const std::int64_t w = v1 / 2 - v0 / 2;
  std::uint64_t e = magnitude(excess), u = magnitude(w);
  scale_down(e, u);
  const std::uint64_t sum = e + isqrt(e * e + u * u);
  // lead = (n +- n w / (A t)) / 2, the sign that of e.
  std::int64_t lead = n / 2;
  if (sum != 0) {
    const auto part = static_cast<std::int64_t>(std::uint64_t{n} * u / sum);
    lead = (static_cast<std::int64_t>(n) + ((w < 0) == (excess < 0) ? part : -part)) / 2;
  }
  const std::int64_t last = static_cast<std::int64_t>(n) - 1;
  lead = lead < 1 ? 1 : lead > last ? last : lead;
  const auto first = static_cast<std::uint32_t>(lead);
  const AxisProfile p = solve(distance, v0, v1, first, 0, n - first);
  if (lead == last) return p;
  const AxisProfile q = solve(distance, v0, v1, first + 1, 0, n - first - 1);
  return peak_accel(q) < peak_accel(p) ? q : p;
}

/// Ticks of a ramp when cruising: n * 2 x g / (x^2 + y^2), rounded up.
std::uint32_t ramp_ticks(std::uint32_t n, std::uint64_t x, std::uint64_t g, std::uint64_t squares) {
  if (squares == 0) return 1;
  const Int128 product = Int128::product(static_cast<std::int64_t>(x * g / 2), 4 * std::int64_t{n});
  // squares < 2^63; reduce both to divide by 32 bits.
  const auto width = static_cast<int>(std::bit_width(squares));
  const int shift = width > 31 ? width - 31 : 0;
  const auto divisor = static_cast<std::uint32_t>(squares >> shift);
  const std::int64_t ticks = (product >> shift).divided_by(divisor).to_int64() + 1;
  return ticks < 1                              ? 1
         : ticks > static_cast<std::int64_t>(n) ? n
                                                : static_cast<std::uint32_t>(ticks);
}

/// Three phases with the cruise at the limit.
AxisProfile three_phases(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t n,
                         std::int64_t vc) {
  std::uint64_t x = magnitude(vc - v0), y = magnitude(vc - v1);
  std::uint64_t g = magnitude(vc - distance.divided_by(n).to_int64());
  const auto width = static_cast<int>(std::bit_width(x | y | g));
  if (width > 31) {
    x >>= width - 31;
    y >>= width - 31;
    g >>= width - 31;
  }
  const std::uint64_t squares = x * x + y * y;
  std::uint32_t lead = ramp_ticks(n, x, g, squares);
  std::uint32_t tail = ramp_ticks(n, y, g, squares);
  if (lead + tail >= n) return two_phases(distance, v0, v1, n);
  const AxisProfile p = solve(distance, v0, v1, lead, n - lead - tail, tail);
  if (lead + tail + 1 == n) return p;
  // Whole ticks make the cruise a little faster, which affects a short ramp: lengthen the steeper.
  ++(abs64(p.lead_accel_q62) > abs64(p.tail_accel_q62) ? lead : tail);
  const AxisProfile q = solve(distance, v0, v1, lead, n - lead - tail, tail);
  return peak_accel(q) < peak_accel(p) ? q : p;
}

void widen(Excursion& e, Int128 way) {
  if (way < e.low_q62) e.low_q62 = way;
  if (way > e.high_q62) e.high_q62 = way;
}

/// Adds a stair that starts at `way`: its turning point, if it has one, and its end.
Int128 widen_by_stair(Excursion& e, Int128 way, std::int64_t speed, std::int64_t accel,
                      std::uint32_t ticks) {
  if (speed != 0 && accel != 0 && (speed < 0) != (accel < 0)) {
    const std::int64_t turn = abs64(speed) / abs64(accel);
    if (turn < static_cast<std::int64_t>(ticks)) {
      widen(e, way + stepper::displacement_q62(speed, accel, static_cast<std::uint32_t>(turn)));
      widen(e, way + stepper::displacement_q62(speed, accel, static_cast<std::uint32_t>(turn) + 1));
    }
  }
  const Int128 end = way + stepper::displacement_q62(speed, accel, ticks);
  widen(e, end);
  return end;
}

/// Adds a phase, stair by stair.
Int128 widen_by_phase(Excursion& e, Int128 way, std::int64_t speed, std::int64_t accel,
                      std::uint32_t ticks, std::uint8_t ramp) {
  stepper::Stair stair;
  for (std::uint32_t i = stepper::first_stair(ramp);
       stepper::next_stair(accel, ticks, ramp, i, stair); ++i) {
    way = widen_by_stair(e, way, speed, stair.accel_q62, stair.ticks);
    speed += stair.accel_q62 * static_cast<std::int64_t>(stair.ticks);
  }
  return way;
}

}  // namespace

bool make_cruise(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t ticks,
                 AxisProfile& profile) {
  // Distance error that any profile may have; the next one compensates for it.
  constexpr std::int64_t millionth_step_q62 = one_q62 >> 20;
  if (v0 == 0 || v1 == 0) {
    if (v0 != v1 || distance != Int128(0)) return false;
  } else {
    const Int128 off = distance - Int128::times(v0, ticks);
    if (off > Int128(millionth_step_q62) || off < Int128(-millionth_step_q62)) return false;
    if (abs64(v1 - v0) > millionth_step_q62 / static_cast<std::int64_t>(ticks)) return false;
  }
  profile = AxisProfile{};
  profile.speed_q62 = v0;
  profile.cruise_ticks = ticks;
  return true;
}

void set_turns(AxisProfile& p) {
  p.lead_turn_ticks = turn_of_phase(p.speed_q62, p.lead_accel_q62, p.lead_ticks, p.lead_ramp);
  p.tail_turn_ticks =
      turn_of_phase(p.cruise_speed_q62(), p.tail_accel_q62, p.tail_ticks, p.tail_ramp);
}

AxisProfile make_profile(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t ticks,
                         std::int64_t speed) {
  AxisProfile p = two_phases(distance, v0, v1, ticks);
  const std::int64_t peak = p.cruise_speed_q62();
  if (abs64(peak) > speed) p = three_phases(distance, v0, v1, ticks, peak < 0 ? -speed : speed);
  set_turns(p);
  return p;
}

AxisProfile make_phases(Int128 distance, std::int64_t v0, std::int64_t v1, std::uint32_t lead,
                        std::uint32_t cruise, std::uint32_t tail) {
  AxisProfile p = solve(distance, v0, v1, lead, cruise, tail);
  set_turns(p);
  return p;
}

std::uint32_t braking_ticks(std::int64_t v0, std::int64_t accel) {
  return static_cast<std::uint32_t>((abs64(v0) + accel - 1) / accel);
}

std::int64_t steady_speed_q32(std::int64_t q, std::int64_t v0, std::int64_t v1,
                              std::int32_t beats) {
  const std::int64_t t = std::int64_t{beats} << 32;
  const std::int64_t low = v0 < v1 ? v0 : v1, high = v0 < v1 ? v1 : v0;
  // Distance at the lower end speed until the ramp to the other one; and the reverse.
  const std::int64_t change = high - low, rest = t - change;
  const std::int64_t ramp = mul_q32(change, (low + high) / 2);
  const std::int64_t squares = (mul_q32(v0, v0) + mul_q32(v1, v1)) / 2;
  if (q > ramp + mul_q32(rest, high)) {  // above both: v^2 - (t + v0 + v1) v + q + squares = 0
    const std::int64_t half = (t + v0 + v1) / 2;
    return half - sqrt_down_q32(mul_q32(half, half) - q - squares);
  }
  if (q < ramp + mul_q32(rest, low)) {  // below both: the same mirrored
    const std::int64_t half = (t - v0 - v1) / 2;
    return sqrt_down_q32(mul_q32(half, half) + q - squares) - half;
  }
  return rest > 0 ? low + ratio_q32(q - ramp - mul_q32(rest, low), rest) : low;
}

AxisProfile make_steady_profile(Int128 distance, std::int64_t v0, std::int64_t v1,
                                std::uint32_t ticks, std::uint32_t lead, std::uint32_t tail,
                                std::int64_t accel) {
  if (lead < 1) lead = 1;
  if (tail < 1) tail = 1;
  AxisProfile p;
  for (int tries = 0; tries < max_tries; ++tries) {
    if (lead + tail > ticks) (lead > tail ? lead : tail) -= lead + tail - ticks;
    p = solve(distance, v0, v1, lead, ticks - lead - tail, tail);
    // Whole ticks change the steady speed a little, which affects a short ramp: lengthen it.
    if (abs64(p.lead_accel_q62) > accel) lead += 1 + lead / 1024;
    if (abs64(p.tail_accel_q62) > accel) tail += 1 + tail / 1024;
    if (peak_accel(p) <= accel) break;
  }
  set_turns(p);
  return p;
}

AxisProfile make_brake(std::int64_t v0, std::int64_t accel, std::uint32_t ticks) {
  AxisProfile p;
  const std::uint32_t lead = braking_ticks(v0, accel);
  p.cruise_ticks = ticks - lead;
  p.lead_ticks = lead;
  p.speed_q62 = v0;
  if (lead != 0) p.lead_accel_q62 = even(-v0 / static_cast<std::int64_t>(lead));
  return p;
}

bool within_limits(const AxisProfile& p, std::int64_t speed, std::int64_t accel) {
  return abs64(p.speed_q62) <= speed && abs64(p.cruise_speed_q62()) <= speed &&
         abs64(p.end_speed_q62()) <= speed && abs64(p.lead_accel_q62) <= accel &&
         abs64(p.tail_accel_q62) <= accel;
}

Excursion excursion(const AxisProfile& p) {
  Excursion e;
  const std::int64_t cruise = p.cruise_speed_q62();
  Int128 way = widen_by_phase(e, 0, p.speed_q62, p.lead_accel_q62, p.lead_ticks, p.lead_ramp);
  way = widen_by_stair(e, way, cruise, 0, p.cruise_ticks);
  widen_by_phase(e, way, cruise, p.tail_accel_q62, p.tail_ticks, p.tail_ramp);
  return e;
}

}  // namespace lamplock::motion
