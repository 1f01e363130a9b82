#include "firmware/motion/line_geometry.hpp"

#include <bit>

namespace lamplock::motion {
namespace {

/// Room between the limits and what is planned with, for rounding: 1/512 of an acceleration, which
/// feels what is left of a way in a short time; 1/8192 of a speed.
constexpr int accel_room_bits = 9;
constexpr int speed_room_bits = 13;
/// The ramp of a pulse is found to 1/256 of its length, its peak may be higher by twice that.
constexpr int pulse_room_bits = 6;
/// Changes of direction below this are rounding of the cosines themselves.
constexpr std::uint32_t noise_q30 = 16;
constexpr std::int64_t dot_noise_q60 = std::int64_t{noise_q30} << 32;
constexpr std::int64_t one_q60 = std::int64_t{1} << 60;
/// Stands for any speed, squared.
Real endless() { return Real(1u, 40); }

std::uint64_t magnitude(std::int64_t v) { return static_cast<std::uint64_t>(abs64(v)); }

Real limit(std::int64_t value, int bits, Real unit) { return Real(magnitude(value), -bits) * unit; }
Real with_room(Real value, int bits) { return difference(value, times_power(value, -bits)); }

/// How a direction changes from one line to the next.
struct Turn {
  PerAxis<std::uint32_t> change_q30{};  ///< beyond rounding
  std::uint64_t square_q60 = 0;         ///< of all together
  bool back = false;                    ///< the way it came
};

Turn make_turn(const LineShape& from, const LineShape& to, const LineLimits& limits) {
  std::int64_t dot_q60 = 0;
  for (int a = 0; a < limits.axes; ++a)
    dot_q60 += std::int64_t{from.cosine_q30[index(a)]} * to.cosine_q30[index(a)];
  const bool sharp = dot_q60 < -dot_noise_q60;
  const Real step(1u);
  const Real per_length = step / from.length + step / to.length;
  Turn turn;
  turn.back = sharp;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t u = from.cosine_q30[index(a)], v = to.cosine_q30[index(a)];
    const auto rounding = static_cast<std::uint64_t>(
        (limits.axis[index(a)].unit * per_length).fixed(30) + std::int64_t{noise_q30});
    if (magnitude(u + v) > rounding) turn.back = false;
    const std::uint64_t change = magnitude(v - u);
    if (!sharp && change <= rounding) continue;
    // Near a way back, noise is rather a sharper turn.
    const auto left = static_cast<std::uint32_t>(sharp ? change + noise_q30 : change - rounding);
    turn.change_q30[index(a)] = left;
    turn.square_q60 += wide_product(left, left);
  }
  return turn;
}

/// Acceleration of the axes in the direction of the change.
Real turn_accel(const Turn& turn, Real chord, const LineLimits& limits) {
  Real lowest = endless();
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint32_t change = turn.change_q30[index(a)];
    if (change == 0) continue;
    lowest = least(lowest, limits.axis[index(a)].accel * chord / Real(change, -30));
  }
  return lowest;
}

/// Square of the highest speed at which no axis jumps by more than it may.
Real jump_speed_2(const Turn& turn, const LineLimits& limits) {
  Real lowest = endless();
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint32_t change = turn.change_q30[index(a)];
    if (change == 0) continue;
    const Real jump = limits.axis[index(a)].jump;
    if (is_zero(jump)) return {};
    lowest = least(lowest, jump / Real(change, -30));
  }
  return lowest * lowest;
}

/// Half the turn as sine and cosine: the change of direction is twice the sine.
struct HalfTurn {
  Real chord, sine, cosine;
};

HalfTurn half_of(const Turn& turn) {
  const std::uint64_t quarter = turn.square_q60 / 4;
  const std::uint64_t rest =
      quarter < std::uint64_t{one_q60} ? std::uint64_t{one_q60} - quarter : 0;
  const Real chord = square_root(Real(turn.square_q60, -60));
  return {chord, times_power(chord, -1), square_root(Real(rest, -60))};
}

/// Radius of the circle that touches both lines in the middle of the shorter one.
Real middle_radius(const LineShape& from, const LineShape& to, const HalfTurn& half) {
  return times_power(least(from.length, to.length), -1) * half.cosine / half.sine;
}

}  // namespace

LineLimits make_line_limits(const Limits& limits, std::int32_t coarsest_milli,
                            std::uint32_t deviation_nm) {
  LineLimits out;
  out.axes = limits.axes;
  const Real per_mm = Real(magnitude(coarsest_milli)) / Real(1000u);
  // um/min: / 1000 um / (60 s).
  out.um_min = per_mm / Real(1000u) / Real(60u * ticks_per_second);
  out.deviation = per_mm * Real(deviation_nm) / Real(1'000'000u);
  for (int a = 0; a < limits.axes; ++a) {
    const AxisLimits& axis = limits.axis[index(a)];
    LineAxis& line = out.axis[index(a)];
    line.weight_q31 = axis.weight_q31;
    line.unit = Real(axis.weight_q31, -31);
    line.speed = with_room(limit(axis.speed_q62, 62, line.unit), speed_room_bits);
    line.accel = with_room(limit(axis.accel_q62, 62, line.unit), accel_room_bits);
    line.jump = limit(axis.jump_q62, 62, line.unit);
  }
  out.rise = make_rise(limits);
  if (out.rise.none()) return out;
  for (LineAxis& axis : out.axis) axis.accel = with_room(axis.accel, pulse_room_bits);
  return out;
}

LineShape make_shape(const PerAxis<std::int64_t>& steps, const LineLimits& limits) {
  PerAxis<std::int64_t> weighted_q31{};
  std::uint64_t all = 0;
  for (int a = 0; a < limits.axes; ++a) {
    weighted_q31[index(a)] = steps[index(a)] * std::int64_t{limits.axis[index(a)].weight_q31};
    all |= magnitude(weighted_q31[index(a)]);
  }
  LineShape shape;
  if (all == 0) return shape;
  // The longest gets 30 bits, so that four squares fit.
  const int left = std::countl_zero(all) - 34;
  std::uint64_t squares = 0;
  PerAxis<std::uint32_t> part{};
  for (int a = 0; a < limits.axes; ++a) {
    const std::uint64_t m = magnitude(weighted_q31[index(a)]);
    part[index(a)] = static_cast<std::uint32_t>(left >= 0 ? m << left : m >> -left);
    squares += wide_product(part[index(a)], part[index(a)]);
  }
  const std::uint32_t root = isqrt(squares);
  shape.length = Real(root, -31 - left);
  // The root is 2^29 at least.
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero)
  const std::uint64_t inverse = (std::uint64_t{1} << 61) / root;
  const auto per_root = static_cast<std::uint32_t>(inverse >> 32 != 0 ? 0xffffffffu : inverse);
  for (int a = 0; a < limits.axes; ++a) {
    const auto c = static_cast<std::int32_t>(wide_product(part[index(a)], per_root) >> 31);
    shape.cosine_q30[index(a)] = weighted_q31[index(a)] < 0 ? -c : c;
  }
  return shape;
}

LineBounds make_bounds(const LineShape& shape, const LineLimits& limits) {
  LineBounds bounds{endless(), endless()};
  for (int a = 0; a < limits.axes; ++a) {
    // What is less than the cosines can show is shown as 1.
    const std::uint64_t cosine = magnitude(shape.cosine_q30[index(a)]);
    if (cosine == 0) continue;
    const Real per = Real(1u, 30) / Real(cosine + 1);
    const LineAxis& axis = limits.axis[index(a)];
    bounds.speed = least(bounds.speed, axis.speed * per);
    bounds.accel = least(bounds.accel, axis.accel * per);
  }
  return bounds;
}

Real corner_speed_2(const LineShape& from, const LineShape& to, const LineLimits& limits) {
  const Turn turn = make_turn(from, to, limits);
  if (turn.back) return {};
  if (turn.square_q60 == 0) return endless();
  const HalfTurn half = half_of(turn);
  // d s/(1 - s) with s the cosine: d s (1 + s) / sine^2.
  const Real by_deviation =
      limits.deviation * half.cosine * (Real(1u) + half.cosine) / (half.sine * half.sine);
  const Real radius = least(by_deviation, middle_radius(from, to, half));
  return most(radius * turn_accel(turn, half.chord, limits), jump_speed_2(turn, limits));
}

Real curve_speed_2(const LineShape& from, const LineShape& to, const LineLimits& limits) {
  const Turn turn = make_turn(from, to, limits);
  if (turn.square_q60 == 0) return endless();
  const HalfTurn half = half_of(turn);
  const Real by_circle = middle_radius(from, to, half) * turn_accel(turn, half.chord, limits);
  return most(by_circle, jump_speed_2(turn, limits));
}

}  // namespace lamplock::motion
