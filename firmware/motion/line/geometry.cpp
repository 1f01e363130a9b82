#include "firmware/motion/line/geometry.hpp"

#include <bit>

namespace lamplock::motion {
namespace {

/// Room between the limits and the planning limits, for rounding: 1/512 of an acceleration, which
/// the rest of a way affects in a short time; 1/8192 of a speed.
constexpr int accel_room_bits = 9;
constexpr int speed_room_bits = 13;
/// The ramp of a pulse is found to 1/256 of its length, its peak may be higher by twice that.
constexpr int pulse_room_bits = 6;
/// Rounding of a way: its ends are rounded to places, 2 edge_q8, and the numbers of a program to
/// 1/1000 inch.
constexpr int place_rounding_bits = 4;
static_assert((2 * edge_q8) << place_rounding_bits == 1 << place_bits);
constexpr std::uint32_t written_nm = 25'400;
/// Changes of direction below this are rounding of the cosines themselves.
constexpr std::uint32_t noise_q30 = 16;
/// Above every change.
constexpr std::uint32_t max_rounding_q30 = std::uint32_t{1} << 31;
constexpr std::int64_t dot_noise_q60 = std::int64_t{noise_q30} << 32;
constexpr std::int64_t one_q60 = std::int64_t{1} << 60;
/// Square of the gentlest change of direction that is not gentle, 0.7.
constexpr std::uint64_t gentle_turn_q60 = one_q60 / 100 * 49;
/// Square of the smallest change of direction of a corner, and its size in roundings.
constexpr std::uint64_t clear_turn_q60 = one_q60 / 100 * 3;
constexpr std::uint32_t clear_roundings = 3;
/// Squares of sines below 2^-10 are small.
constexpr std::uint64_t small_sine_q60 = std::uint64_t{1} << 50;
/// Square of a speed above all others: no limit.
UFloat endless() { return UFloat::power(40); }

std::uint64_t magnitude(std::int64_t v) { return static_cast<std::uint64_t>(abs64(v)); }
std::uint32_t magnitude(std::int32_t v) {
  return v < 0 ? 0 - static_cast<std::uint32_t>(v) : static_cast<std::uint32_t>(v);
}

UFloat limit(std::int64_t value, int bits, UFloat unit) {
  return UFloat(magnitude(value), -bits) * unit;
}
/// 1 / value, rounded up.
UFloat inverse(UFloat value) {
  if (is_zero(value)) return endless();
  const UFloat down = UFloat::power(0) / value;
  return down + UFloat::power(down.exponent());
}
UFloat with_room(UFloat value, int bits) { return difference(value, times_power(value, -bits)); }

/// Change of direction from one line to the next.
struct Turn {
  PerAxis<std::uint32_t> change_q30{};  ///< beyond rounding
  std::uint64_t square_q60 = 0;         ///< of all axes together
  bool back = false;                    ///< reverses the direction
};

Turn make_turn(const LineShape& from, const LineShape& to, const LineLimits& limits) {
  std::int64_t dot_q60 = 0;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int32_t u = from.cosine_q30[index(a)], v = to.cosine_q30[index(a)];
    const auto product = static_cast<std::int64_t>(wide_product(magnitude(u), magnitude(v)));
    dot_q60 += (u < 0) == (v < 0) ? product : -product;
  }
  const bool sharp = dot_q60 < -dot_noise_q60;
  const UFloat per_length = from.per_length + to.per_length;
  Turn turn;
  turn.back = sharp;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int32_t u = from.cosine_q30[index(a)], v = to.cosine_q30[index(a)];
    const std::uint32_t rounding =
        whole_down(times_power(limits.axis[index(a)].rounding * per_length, 30), max_rounding_q30) +
        noise_q30;
    if (magnitude(u + v) > rounding) turn.back = false;
    const std::uint32_t change = magnitude(v - u);
    // In a sharp turn, too, an axis whose direction does not change is left out.
    if (change <= (sharp ? noise_q30 : rounding)) continue;
    // Near a reversal, noise makes the turn sharper.
    const std::uint32_t left = sharp ? change + noise_q30 : change - rounding;
    turn.change_q30[index(a)] = left;
    turn.square_q60 += wide_product(left, left);
  }
  return turn;
}

/// A corner rather than a bend: a turn of more than 10 degrees of which rounding is a small part.
bool is_clear(const Turn& turn, const LineShape& from, const LineShape& to,
              const LineLimits& limits) {
  if (turn.square_q60 < clear_turn_q60) return false;
  const std::uint32_t rounding_q30 = whole_down(
      times_power(limits.rounding * (from.per_length + to.per_length), 30), max_rounding_q30);
  const std::uint32_t min_q30 = rounding_q30 * clear_roundings;
  return rounding_q30 < max_rounding_q30 / clear_roundings &&
         turn.square_q60 > wide_product(min_q30, min_q30);
}

/// 1 / acceleration of the axes in the direction of the change, times its length.
UFloat change_per_accel(const Turn& turn, const LineLimits& limits) {
  UFloat max_of_all;
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint32_t change = turn.change_q30[index(a)];
    if (change == 0) continue;
    max_of_all = most(max_of_all, limits.axis[index(a)].per_accel * UFloat(change, -30));
  }
  return max_of_all;
}

/// Square of the highest speed at which no axis exceeds its jump.
UFloat jump_speed_2(const Turn& turn, const LineLimits& limits) {
  UFloat lowest = endless();
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint32_t change = turn.change_q30[index(a)];
    if (change == 0) continue;
    const UFloat jump = limits.axis[index(a)].jump;
    if (is_zero(jump)) return {};
    lowest = least(lowest, jump / UFloat(change, -30));
  }
  return lowest * lowest;
}

/// Half the turn: the change of direction is twice its sine.
struct HalfTurn {
  UFloat sine_2, cosine;
};

HalfTurn half_of(const Turn& turn) {
  const std::uint64_t quarter = turn.square_q60 / 4;
  const UFloat sine_2(turn.square_q60, -62);
  const std::uint64_t rest =
      quarter < std::uint64_t{one_q60} ? std::uint64_t{one_q60} - quarter : 0;
  // For small angles 1 - s/2 - s^2/2 with s the square of the sine, slightly less than the root.
  if (quarter < small_sine_q60) {
    const auto s = static_cast<std::uint32_t>(quarter >> 29);  // Q31
    return {sine_2, UFloat((std::uint32_t{1} << 31) - s / 2 - (s >> 16) * (s >> 16) / 2 - 1, -31)};
  }
  return {sine_2, square_root(UFloat(rest, -60))};
}

/// With r the radius of the circle that touches both lines in the middle of the shorter one,
/// l/2 cosine / sine, and with the acceleration, chord / m: the product is l cosine / m.
UFloat middle_speed_2(UFloat shorter, const HalfTurn& half, UFloat change_per_accel) {
  return shorter * half.cosine / change_per_accel;
}

}  // namespace

LineLimits make_line_limits(const Limits& limits, std::int32_t coarsest_milli,
                            std::uint32_t deviation_nm) {
  LineLimits out;
  out.axes = limits.axes;
  const UFloat per_mm = UFloat(magnitude(coarsest_milli)) / UFloat(1000u);
  // um/min: / 1000 um / (60 s).
  out.um_min = per_mm / UFloat(1000u) / UFloat(60u * ticks_per_second);
  out.deviation = per_mm * UFloat(deviation_nm) / UFloat(1'000'000u);
  out.um_q8 = whole_down(times_power(per_mm / UFloat(1000u), 8), 0xffffu);
  const UFloat written = per_mm * UFloat(written_nm) / UFloat(1'000'000u);
  for (int a = 0; a < limits.axes; ++a) {
    const AxisLimits& axis = limits.axis[index(a)];
    LineAxis& line = out.axis[index(a)];
    line.weight_q31 = axis.weight_q31;
    line.unit = UFloat(axis.weight_q31, -31);
    line.rounding = least(line.unit, times_power(line.unit, -place_rounding_bits) + written);
    out.rounding = most(out.rounding, line.rounding);
    line.speed = with_room(limit(axis.speed_q62, 62, line.unit), speed_room_bits);
    line.accel = with_room(limit(axis.accel_q62, 62, line.unit), accel_room_bits);
    line.jump = limit(axis.jump_q62, 62, line.unit);
  }
  out.rise = make_rise(limits);
  for (int a = 0; a < limits.axes; ++a) {
    LineAxis& axis = out.axis[index(a)];
    if (!out.rise.none()) axis.accel = with_room(axis.accel, pulse_room_bits);
    axis.per_speed = inverse(axis.speed);
    axis.per_accel = inverse(axis.accel);
  }
  return out;
}

namespace {

/// A way in parts of 30 bits, for sums of four squares: weighted q31 parts, 2^`left` times as
/// large.
struct ScaledWay {
  PerAxis<std::uint32_t> part{};
  int left = 0;
  std::uint32_t root = 0;  ///< of the squares: at least 2^29; 0 = no displacement
};

ScaledWay scaled_way(const WayParts& way, const LineLimits& limits) {
  PerAxis<std::uint64_t> weighted_q31{};
  std::uint64_t all = 0;
  for (int a = 0; a < limits.axes; ++a) {
    const auto size = static_cast<std::uint32_t>(magnitude(way.parts[index(a)]));
    if (size == 0) continue;
    weighted_q31[index(a)] = wide_product(size, limits.axis[index(a)].weight_q31);
    all |= weighted_q31[index(a)];
  }
  ScaledWay scaled;
  if (all == 0) return scaled;
  // The longest part gets 30 bits, so that four squares fit.
  scaled.left = std::countl_zero(all) - 34;
  std::uint64_t squares = 0;
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint64_t m = weighted_q31[index(a)];
    if (m == 0) continue;
    const auto part =
        static_cast<std::uint32_t>(scaled.left >= 0 ? m << scaled.left : m >> -scaled.left);
    scaled.part[index(a)] = part;
    squares += wide_product(part, part);
  }
  scaled.root = isqrt(squares);
  return scaled;
}

UFloat length_of(const ScaledWay& scaled, int bits) {
  return UFloat(scaled.root, -31 - scaled.left - bits);
}

}  // namespace

UFloat length_of(const WayParts& way, const LineLimits& limits) {
  return length_of(scaled_way(way, limits), way.bits);
}

LineShape make_shape(const WayParts& way, const LineLimits& limits) {
  const ScaledWay scaled = scaled_way(way, limits);
  LineShape shape;
  if (scaled.root == 0) return shape;
  shape.length = length_of(scaled, way.bits);
  shape.per_length = UFloat::power(0) / shape.length;
  // 2^61 / root, 32 bits.
  const std::uint32_t per_root =
      whole_down(times_power(shape.per_length, 30 - scaled.left - way.bits), 0xffffffffu);
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint32_t part = scaled.part[index(a)];
    if (part == 0) continue;
    const auto c = static_cast<std::int32_t>(wide_product(part, per_root) >> 31);
    shape.cosine_q30[index(a)] = way.parts[index(a)] < 0 ? -c : c;
  }
  return shape;
}

LineBounds make_bounds(const LineShape& shape, const LineLimits& limits) {
  UFloat per_speed, per_accel;
  for (int a = 0; a < limits.axes; ++a) {
    // Shares below the resolution of the cosines count as 1.
    const std::uint32_t cosine = magnitude(shape.cosine_q30[index(a)]);
    if (cosine == 0) continue;
    const UFloat share(cosine + 1, -30);
    const LineAxis& axis = limits.axis[index(a)];
    per_speed = most(per_speed, axis.per_speed * share);
    per_accel = most(per_accel, axis.per_accel * share);
  }
  const UFloat one = UFloat::power(0);
  return {one / per_speed, one / per_accel};
}

LineCorner corner_of(const LineShape& from, const LineShape& to, const LineLimits& limits) {
  const Turn turn = make_turn(from, to, limits);
  if (turn.back) return {{}, true};
  if (turn.square_q60 == 0) return {endless()};
  const HalfTurn half = half_of(turn);
  UFloat shorter = least(from.length, to.length);
  // The radius by the deviation is d s/(1 - s) with s the cosine, d s (1 + s) / sine^2: as if the
  // lines were 2 d (1 + s) / sine long.
  const UFloat twice = times_power(limits.deviation * (UFloat::power(0) + half.cosine), 1);
  if (twice * twice < shorter * shorter * half.sine_2) shorter = twice / square_root(half.sine_2);
  return {most(middle_speed_2(shorter, half, change_per_accel(turn, limits)),
               jump_speed_2(turn, limits)),
          is_clear(turn, from, to, limits)};
}

UFloat curve_speed_2(const LineShape& from, const LineShape& to, LineBends bends,
                     const LineLimits& limits) {
  const Turn turn = make_turn(from, to, limits);
  if (turn.square_q60 == 0) return endless();
  if (bends == LineBends::gentle && turn.square_q60 > gentle_turn_q60) return endless();
  const UFloat by_circle =
      middle_speed_2(least(from.length, to.length), half_of(turn), change_per_accel(turn, limits));
  return most(by_circle, jump_speed_2(turn, limits));
}

}  // namespace lamplock::motion
