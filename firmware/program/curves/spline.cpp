#include "firmware/program/curves/spline.hpp"

#include <algorithm>
#include <bit>

#include "firmware/program/curves/spline_length.hpp"
#include "firmware/program/wide_number.hpp"

namespace lamplock::program {
namespace {

bool is_spline(const SplineRequest& request) {
  return sane(request.start, request.plane) && sane(request.first_control, request.plane) &&
         sane(request.second_control, request.plane) && sane(request.end, request.plane);
}

/// Coefficients have this many additional bits, so that a point is rounded once. Without them no
/// coefficient or intermediate sum is above 12 2^46, and times_q48() accepts 2^55.
constexpr int spline_fine_bits = 4;
constexpr std::int64_t fine = 1 << spline_fine_bits;

/// Least n with n n >= x.
std::uint32_t root_up(std::uint64_t x) {
  const std::uint32_t root = isqrt(x);
  return std::uint64_t{root} * root < x ? root + 1 : root;
}

/// x / y rounded up, for x below 2^62.
std::uint64_t quotient_up(std::uint64_t x, std::uint64_t y) { return (x + y - 1) / y; }

/// 3/4 of the longer second difference over the tolerance, and its root.
std::uint32_t pieces_for(std::int64_t second_difference, std::int64_t tolerance_e7) {
  const std::int64_t tolerance = std::clamp<std::int64_t>(tolerance_e7, 1, max_coordinate_e7);
  const std::uint64_t square = quotient_up(3 * static_cast<std::uint64_t>(second_difference),
                                           4 * static_cast<std::uint64_t>(tolerance));
  return std::clamp<std::uint32_t>(root_up(square), 1, max_spline_pieces);
}

constexpr std::int64_t one_q48 = std::int64_t{1} << 48;
/// The error of an extreme is the square of that of its parameter.
constexpr std::int64_t extreme_precision_q48 = one_q48 >> 24;

/// Where c + 3 d t is 0, between 0 and 1; 1 if there is no such place.
std::int64_t turning_point_q48(std::int64_t c, std::int64_t d) {
  auto above = static_cast<std::uint64_t>(abs64(c)),
       below = 3 * static_cast<std::uint64_t>(abs64(d));
  if ((c < 0) == (d < 0) || above >= below) return one_q48;
  const int shift = std::max(0, static_cast<int>(std::bit_width(below)) - 47);
  return quotient_q48(above >> shift, below >> shift);
}

}  // namespace

Spline::Cubic Spline::cubic_of(const SplineRequest& request, std::uint8_t axis) {
  const std::int64_t p0 = request.start[axis], p1 = request.first_control[axis],
                     p2 = request.second_control[axis], p3 = request.end[axis];
  return {p0, fine * 3 * (p1 - p0), fine * 3 * (p2 - 2 * p1 + p0),
          fine * (p3 - 3 * p2 + 3 * p1 - p0)};
}

std::int64_t Spline::at(const Cubic& cubic, std::int64_t t_q48) {
  const std::int64_t cd = cubic.c + times_q48(cubic.d, t_q48);
  const std::int64_t bcd = cubic.b + times_q48(cd, t_q48);
  return cubic.a + ((times_q48(bcd, t_q48) + fine / 2) >> spline_fine_bits);
}

Range spline_range(const SplineRequest& request, std::uint8_t axis) {
  Range range{request.start[axis], request.start[axis]};
  range.add(request.end[axis]);
  if (!is_spline(request)) return range;
  // The curve lies between the lowest and the highest of its control points.
  Range hull = range;
  hull.add(request.first_control[axis]);
  hull.add(request.second_control[axis]);
  if (hull.low_e7 == range.low_e7 && hull.high_e7 == range.high_e7) return range;
  const Spline::Cubic cubic = Spline::cubic_of(request, axis);
  const auto slope = [&](std::int64_t t_q48) {
    return cubic.b + times_q48(2 * cubic.c + times_q48(3 * cubic.d, t_q48), t_q48);
  };
  // On either side of the turning point of the slope there is at most one extreme.
  const std::int64_t middle = turning_point_q48(cubic.c, cubic.d);
  for (const auto& [from, to] : {Range{0, middle}, Range{middle, one_q48}}) {
    std::int64_t low = from, high = to;
    const bool rises = slope(low) > 0;
    if (rises == (slope(high) > 0)) continue;
    while (high - low > extreme_precision_q48) {
      const std::int64_t half = (low + high) / 2;
      (rises == (slope(half) > 0) ? low : high) = half;
    }
    range.add(Spline::at(cubic, low));
  }
  return range;
}

Division Spline::begin(const SplineRequest& request, std::int64_t other_way_e7) {
  if (!is_spline(request)) return {1, other_way_e7};
  first_ = cubic_of(request, request.plane.first);
  second_ = cubic_of(request, request.plane.second);
  // c = 3 (P2 - 2 P1 + P0), c + 3 d = 3 (P3 - 2 P2 + P1).
  const std::int64_t bend =
      std::max(length_of(first_.c, second_.c),
               length_of(first_.c + 3 * first_.d, second_.c + 3 * second_.d)) /
      (3 * fine);
  const std::uint32_t pieces = pieces_for(bend, request.tolerance_e7);
  t_q48_.begin(0, std::int64_t{1} << 48, pieces);
  return {pieces, spline_length(request, other_way_e7)};
}

PlanePoint Spline::next(std::uint32_t pieces) {
  const std::int64_t t_q48 = t_q48_.next(pieces);
  return {at(first_, t_q48), at(second_, t_q48)};
}

}  // namespace lamplock::program
