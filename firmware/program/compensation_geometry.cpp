#include "firmware/program/compensation_geometry.hpp"

#include <algorithm>
#include <bit>

#include "firmware/program/angle.hpp"
#include "firmware/program/decimal.hpp"
#include "firmware/program/plane_vector.hpp"
#include "firmware/program/wide_number.hpp"

namespace lamplock::program {
namespace {

/// Paths whose ends are at most this far apart are joined without a corner: 0.0005 mm.
constexpr std::int64_t joined_e7 = 5'000;
/// Intersections are computed with these additional bits: centres are within 2^44, and times_q48()
/// accepts 2^55.
constexpr int corner_bits = 10;

// Directions are vectors of length 1 with 48 fractional bits.
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
Vector from_to(const PlanePoint& a, const PlanePoint& b) {
  return {b.first_e7 - a.first_e7, b.second_e7 - a.second_e7};
}
PlanePoint moved(const PlanePoint& point, Vector v) {
  return {point.first_e7 + v.x, point.second_e7 + v.y};
}
Vector with_corner_bits(Vector v) {
  return {v.x * (std::int64_t{1} << corner_bits), v.y * (std::int64_t{1} << corner_bits)};
}
Vector without_corner_bits(Vector v) {
  constexpr std::int64_t half = std::int64_t{1} << (corner_bits - 1);
  return {(v.x + half) >> corner_bits, (v.y + half) >> corner_bits};
}
/// Of a vector and a direction.
std::int64_t along(Vector v, Vector direction_q48) {
  return times_q48(v.x, direction_q48.x) + times_q48(v.y, direction_q48.y);
}
std::int64_t beside(Vector v, Vector direction_q48) {
  return times_q48(v.y, direction_q48.x) - times_q48(v.x, direction_q48.y);
}
Vector times(std::int64_t length, Vector direction_q48) {
  return {times_q48(length, direction_q48.x), times_q48(length, direction_q48.y)};
}
Vector turned_left(Vector v) { return {-v.y, v.x}; }

/// The direction of a vector, however short.
Vector direction_q48(Vector v) {
  const auto longest = static_cast<std::uint64_t>(abs64(v.x) | abs64(v.y));
  const int shift = std::max(0, 47 - static_cast<int>(std::bit_width(longest)));
  const Vector longer = {v.x * (std::int64_t{1} << shift), v.y * (std::int64_t{1} << shift)};
  const auto length = static_cast<std::uint64_t>(length_of(longer.x, longer.y));
  const auto part = [length](std::int64_t value) {
    const std::int64_t q48 = quotient_q48(static_cast<std::uint64_t>(abs64(value)), length);
    return value < 0 ? -q48 : q48;
  };
  return {part(longer.x), part(longer.y)};
}

Vector tangent_q48(const PlaneBlock& block, const PlanePoint& at) {
  if (!block.arc) return direction_q48(from_to(block.from, block.to));
  const Vector ahead = turned_left(from_to(block.centre, at));
  return direction_q48(block.clockwise ? Vector{-ahead.x, -ahead.y} : ahead);
}

/// The path of the centre beside a block: a line through `place`, or a circle. Relative to a
/// corner, with corner_bits.
struct FinePath {
  Vector place;  ///< or the centre
  Vector direction_q48;
  std::int64_t radius;
  bool arc;
};

bool nearer(Vector a, Vector b) { return dot(a, a) < dot(b, b); }

/// The nearest to the corner of two places at `foot` plus and minus `aside` along a direction.
Vector nearest(Vector foot, std::int64_t aside, Vector direction_q48) {
  const Vector step = times(aside, direction_q48);
  return nearer(foot + step, foot - step) ? foot + step : foot - step;
}

/// Half of a chord at this distance from the centre; false if the circle does not reach it.
bool half_chord(std::int64_t radius, std::int64_t distance, std::int64_t& half) {
  const Int128 square = Int128::product(radius, radius) - Int128::product(distance, distance);
  if (square.negative()) return false;
  half = static_cast<std::int64_t>(wide_root(square));
  return true;
}

bool meet_line(const FinePath& line, const FinePath& circle, Vector& place) {
  const Vector to_centre = circle.place - line.place;
  std::int64_t half = 0;
  if (!half_chord(circle.radius, beside(to_centre, line.direction_q48), half)) return false;
  const Vector foot = line.place + times(along(to_centre, line.direction_q48), line.direction_q48);
  place = nearest(foot, half, line.direction_q48);
  return true;
}

bool meet_circle(const FinePath& first, const FinePath& second, Vector& place) {
  const Vector across = second.place - first.place;
  const std::int64_t apart = length_of(across.x, across.y);
  if (apart == 0 || apart > first.radius + second.radius) return false;
  // Distance of the common chord from the first centre: (r^2 - s^2 + d^2) / 2d.
  const Int128 twice = Int128::product(first.radius, first.radius) -
                       Int128::product(second.radius, second.radius) + dot(across, across);
  const std::uint64_t size = nearest_quotient(twice, static_cast<std::uint64_t>(2 * apart));
  if (size > static_cast<std::uint64_t>(first.radius)) return false;
  const auto distance = static_cast<std::int64_t>(twice.negative() ? 0 - size : size);
  const Vector to_second = direction_q48(across);
  std::int64_t half = 0;
  if (!half_chord(first.radius, distance, half)) return false;
  place = nearest(first.place + times(distance, to_second), half, turned_left(to_second));
  return true;
}

/// The parallels of two lines: r tan(turn / 2) = r sin / (1 + cos) before the corner.
bool meet_lines(Vector out_q48, std::int64_t radius, std::int64_t cosine_q48, std::int64_t sine_q48,
                Vector& place) {
  constexpr std::uint64_t max_back = std::uint64_t{1} << 54;
  const std::int64_t from_reversal_q48 = (std::int64_t{1} << turn_bits) + cosine_q48;
  if (from_reversal_q48 <= 0) return false;
  const std::uint64_t back = nearest_quotient(Int128::product(radius, sine_q48),
                                              static_cast<std::uint64_t>(from_reversal_q48));
  if (back > max_back) return false;
  place = times(radius, turned_left(out_q48)) - times(static_cast<std::int64_t>(back), out_q48);
  return true;
}

/// The path beside a block; the radius is that of the cutter, below 0 if it is on the right.
FinePath path_beside(const PlaneBlock& block, const PlanePoint& corner, Vector tangent_q48,
                     std::int64_t radius) {
  if (!block.arc) return {times(radius, turned_left(tangent_q48)), tangent_q48, 0, false};
  const Vector to_centre = with_corner_bits(from_to(corner, block.centre));
  const std::int64_t own = length_of(to_centre.x, to_centre.y);
  return {to_centre, tangent_q48, block.clockwise ? own + radius : own - radius, true};
}

bool meet(const FinePath& first, const FinePath& second, Vector& place) {
  if (first.arc && second.arc) return meet_circle(first, second, place);
  return first.arc ? meet_line(second, first, place) : meet_line(first, second, place);
}

/// The angle from the begin of an arc to a place, in its direction of turn, from 0 to one turn.
std::int64_t progress_q48(const PlaneBlock& arc, const PlanePoint& place) {
  const Vector from = from_to(arc.centre, arc.from), to = from_to(arc.centre, place);
  const Int128 left = cross(from, to);
  return angle_of(dot(from, to), arc.clockwise ? -left : left);
}

}  // namespace

std::int64_t distance_e7(const PlanePoint& a, const PlanePoint& b) {
  const Vector v = from_to(a, b);
  return length_of(v.x, v.y);
}

bool CutterOffset::fits_into(const PlaneBlock& block) const {
  const bool inside = block.arc && block.clockwise != left_;
  return !inside || std::min(distance_e7(block.centre, block.from),
                             distance_e7(block.centre, block.to)) > radius_e7_;
}

PlanePoint CutterOffset::beside_end(const PlaneBlock& block) const {
  const Vector left = turned_left(tangent_q48(block, block.to));
  return moved(block.to, times(left_ ? radius_e7_ : -radius_e7_, left));
}

bool CutterOffset::turn_corner(const PlaneBlock& first, const PlaneBlock& second,
                               CutterCorner& corner) const {
  const Vector out = tangent_q48(first, first.to), in = tangent_q48(second, second.from);
  const std::int64_t radius = left_ ? radius_e7_ : -radius_e7_;
  corner.end = moved(first.to, times(radius, turned_left(out)));
  corner.begin = moved(first.to, times(radius, turned_left(in)));
  corner.arc = false;
  const std::int64_t ahead = along(in, out), aside = beside(in, out);
  if (ahead > 0 && distance_e7(corner.end, corner.begin) <= joined_e7) {
    corner.end = corner.begin;
    return true;
  }
  if (left_ ? aside <= 0 : aside >= 0) {
    corner.arc = true;
    return true;
  }
  const std::int64_t fine_radius = radius * (std::int64_t{1} << corner_bits);
  Vector place{};
  const bool met = first.arc || second.arc
                       ? meet(path_beside(first, first.to, out, fine_radius),
                              path_beside(second, first.to, in, fine_radius), place)
                       : meet_lines(out, fine_radius, ahead, aside, place);
  corner.end = corner.begin = moved(first.to, without_corner_bits(place));
  return met;
}

BlockPart CutterOffset::part_of(const PlaneBlock& block, const PlanePoint& begin,
                                const PlanePoint& end) const {
  if (!block.arc) {
    const std::int64_t way =
        along(from_to(begin, end), direction_q48(from_to(block.from, block.to)));
    return way < -joined_e7 ? BlockPart::backward : BlockPart::some;
  }
  // Ends of joined paths are beside those of the arc by this angle.
  constexpr std::int64_t e7_q48_of_radian = joined_e7 * (turn_q48 / 44 * 7);
  const std::int64_t slack =
      std::min(turn_q48 / 8, e7_q48_of_radian / (distance_e7(block.centre, end) + 1));
  const Vector from = from_to(block.centre, block.from), to = from_to(block.centre, block.to);
  const bool whole = cross(from, to) == Int128{} && !dot(from, to).negative();
  const std::int64_t sweep = whole ? turn_q48 : progress_q48(block, block.to);
  // Angles beyond the arc belong to its begin or to its end, whichever is nearer.
  const std::int64_t limit = std::min(sweep + (turn_q48 - sweep) / 2, turn_q48 - slack);
  std::int64_t at_begin = progress_q48(block, begin), at_end = progress_q48(block, end);
  if (at_begin > limit) at_begin -= turn_q48;
  if (whole && at_end < slack) at_end += turn_q48;
  if (!whole && at_end > limit) at_end -= turn_q48;
  if (at_begin < -slack || at_end > sweep + slack) return BlockPart::backward;
  const std::int64_t left = at_end - at_begin;
  if (left < -slack) return BlockPart::backward;
  return left <= slack ? BlockPart::none : left < turn_q48 ? BlockPart::some : BlockPart::circle;
}

}  // namespace lamplock::program
