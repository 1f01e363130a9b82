#include "firmware/program/curves/arc.hpp"

#include <algorithm>
#include <bit>

#include "firmware/program/angle.hpp"
#include "firmware/program/plane_vector.hpp"
#include "firmware/program/wide_number.hpp"

namespace lamplock::program {
namespace {

/// Limits of a piece.
constexpr std::int64_t min_tolerance_e7 = 50;
constexpr std::int64_t max_piece_q48 = turn_q48 / 4;
constexpr int max_pieces_bits = 30;

/// Vectors are turned with this many additional bits, so that a point is rounded once; they have at
/// most 2^47 on each axis, and times_q48() accepts 2^55.
constexpr int fine_bits = 7;

/// Maximum by which a radius may be too short for its half circle, 0.00127 mm (0.00005 inches):
/// rs274 of LinuxCNC 2.9 accepts so much, in both units.
constexpr std::int64_t max_radius_short_e7 = 12'700;

/// grbl 1.1, error 33.
constexpr std::int64_t radii_alike_e7 = one_e7 / 200;
constexpr std::int64_t radii_apart_e7 = one_e7 / 2;
constexpr std::int64_t radius_share = 1000;

/// Radii that differ only by rounding.
constexpr std::int64_t round_e7 = 2;

/// Parts of a spiral that are sampled for its length.
constexpr int length_parts = 16;

Vector from_to(const Place& a, const Place& b, const CurvePlane& plane) {
  return {b[plane.first] - a[plane.first], b[plane.second] - a[plane.second]};
}

Vector turned(Vector v, std::int64_t angle_q48) {
  const SineCosine turn = sine_cosine(angle_q48);
  return {times_q48(v.x, turn.cosine_q48) - times_q48(v.y, turn.sine_q48),
          times_q48(v.x, turn.sine_q48) + times_q48(v.y, turn.cosine_q48)};
}

Vector finely(Vector v) {
  return {v.x * (std::int64_t{1} << fine_bits), v.y * (std::int64_t{1} << fine_bits)};
}
std::int64_t coarsely(std::int64_t v) { return (v + (1 << (fine_bits - 1))) >> fine_bits; }

/// Both ends as seen from the centre.
struct Ends {
  Vector start, end;
  std::int64_t start_radius, end_radius;
};
Ends ends_of(const ArcRequest& request) {
  const Vector start = from_to(request.centre, request.start, request.plane);
  const Vector end = from_to(request.centre, request.end, request.plane);
  return {start, end, length_of(start.x, start.y), length_of(end.x, end.y)};
}

bool is_arc(const ArcRequest& request) {
  return sane(request.start, request.plane) && sane(request.end, request.plane) &&
         sane(request.centre, request.plane);
}

/// The total angle, further turns included; always above 0.
std::int64_t sweep_of(const Ends& ends, const ArcRequest& request) {
  const Int128 along = dot(ends.start, ends.end), across = cross(ends.start, ends.end);
  const bool same_direction = across == Int128{} && !along.negative();
  std::int64_t angle = turn_q48;
  if (!same_direction) {
    angle = angle_of(along, request.clockwise ? -across : across);
    // Rounding must not give no turn or a full turn.
    angle = std::clamp<std::int64_t>(angle, 1, turn_q48 - 1);
  }
  const std::uint32_t turns = request.turns > 1 ? std::min(request.turns - 1, max_turns) : 0;
  return angle + turns * turn_q48;
}

/// Whether an arc passes the directions of the axes, seen from its centre.
struct Quarters {
  bool right, up, left, down;
};

[[gnu::cold]] Quarters quarters_of(const Ends& ends, const ArcRequest& request) {
  const Vector from = request.clockwise ? ends.end : ends.start;
  const Vector to = request.clockwise ? ends.start : ends.end;
  const Int128 across = cross(from, to);
  const bool straight = across == Int128{}, same_direction = straight && !dot(from, to).negative();
  if (same_direction || request.turns > 1) return {true, true, true, true};
  // Anticlockwise from `from` to `to`: up to half a turn, or all but less than half a turn.
  const bool short_way = straight || !across.negative();
  const auto passes = [&](std::int64_t from_across, std::int64_t across_to) {
    return short_way ? from_across >= 0 && across_to >= 0 : from_across >= 0 || across_to >= 0;
  };
  return {passes(-from.y, to.y), passes(from.x, -to.x), passes(from.y, -to.y),
          passes(-from.x, to.x)};
}

/// 2 r' of a spiral: twice the change of the radius per radian; at least that.
std::int64_t twice_slope(std::int64_t change, std::int64_t sweep_q48) {
  // A shorter sweep deviates from its chord by at most a quarter of the sweep times the change: 1
  // e7.
  if (sweep_q48 < turn_q48 >> 20) return 0;
  // 2^49 change / sweep / 2 pi, with 32 bits of the sweep.
  const int shift = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(sweep_q48))) - 32;
  const auto divisor =
      static_cast<std::uint32_t>(shift < 0 ? sweep_q48 << -shift : sweep_q48 >> shift);
  constexpr std::int64_t max_change = std::int64_t{1} << 40;  // the result has at most 61 bits
  const Int128 dividend = Int128(std::min(change, max_change)) << (49 - shift);
  return times_q62(dividend.divided_by(divisor).to_int64(), turns_of_radian_q62) + 1;
}

/// The largest angle whose chord keeps the tolerance, on a circle.
std::int64_t max_angle(std::int64_t radius, std::int64_t tolerance) {
  if (tolerance >= radius) return max_piece_q48;
  constexpr int more_bits = 15;  // 2^15 2^47 and (2^30 2^47 2^48) fit
  const Int128 square = Int128::product(tolerance, 2 * radius - tolerance) << (2 * more_bits);
  const auto half_chord = static_cast<std::int64_t>(wide_root(square));
  const Int128 to_chord = Int128(radius - tolerance) << more_bits;
  const std::int64_t angle = 2 * angle_of(to_chord, half_chord);
  return std::min(angle, max_piece_q48);
}

std::uint32_t pieces_of(const Ends& ends, std::int64_t sweep_q48, std::int64_t tolerance_e7) {
  std::int64_t radius = std::max(ends.start_radius, ends.end_radius);
  const std::int64_t tolerance = std::clamp(tolerance_e7, min_tolerance_e7, max_coordinate_e7);
  const std::int64_t change = abs64(ends.end_radius - ends.start_radius);
  if (change > round_e7) {
    radius = length_of(radius, twice_slope(change, sweep_q48));
    // The product of a tolerance and this radius must have 96 bits.
    radius = std::min(radius, 2 * max_coordinate_e7);
  }
  const std::int64_t piece =
      std::max(max_angle(radius, tolerance), (sweep_q48 >> max_pieces_bits) + 1);
  return static_cast<std::uint32_t>((sweep_q48 + piece - 1) / piece);
}

/// The length if the whole spiral were like its place `part`.
std::int64_t length_like(const Ends& ends, std::int64_t sweep_q48, int part) {
  const std::int64_t change = ends.end_radius - ends.start_radius;
  const std::int64_t radius_parts = ends.start_radius * length_parts + change * part;
  // That times sweep times 2 pi, in eighths: 2^-48 2^-4 2^3.
  const Int128 eighths = Int128::product(radius_parts, sweep_q48) >> 49;
  // Only ten thousand turns of a radius beyond the machine exceed this.
  const std::int64_t most = std::min(eighths, Int128(one_q62)).to_int64();
  return length_of(times_q62(most, radians_of_eighth_q62), change);
}

std::int64_t length_in_plane(const Ends& ends, std::int64_t sweep_q48) {
  // The place in the middle is wrong by up to 1/96 (change / radius)^2.
  if (abs64(ends.end_radius - ends.start_radius) <= ends.start_radius / 16)
    return length_like(ends, sweep_q48, length_parts / 2);
  // Simpson's rule.
  Int128 sum;
  for (int part = 0; part <= length_parts; ++part) {
    const int twice = part == 0 || part == length_parts ? 0 : part % 2 == 0 ? 1 : 2;
    sum = sum + (Int128(length_like(ends, sweep_q48, part)) << twice);
  }
  return sum.divided_by(3 * length_parts).to_int64();
}

}  // namespace

bool centre_of_radius(const Place& start, const Place& end, const CurvePlane& plane,
                      std::int64_t radius_e7, bool clockwise, Place& centre) {
  if (!sane(start, plane) || !sane(end, plane) || !sane(radius_e7)) return false;
  const Vector way = from_to(start, end, plane);
  const std::int64_t two_radii = 2 * abs64(radius_e7);
  const Int128 square = dot(way, way);
  const std::int64_t reach = two_radii + 2 * max_radius_short_e7;
  if (square == Int128{} || two_radii == 0 || Int128::product(reach, reach) < square) return false;

  // Twice the distance of the centre from the middle between start and end; 0 where the points are
  // at the maximum distance.
  const Int128 rest = Int128::product(two_radii, two_radii) - square;
  const std::int64_t twice_aside_q6 =
      64 * static_cast<std::int64_t>(rest.negative() ? 0 : wide_root(rest));
  // The direction from start to end, however short the distance.
  const auto longest = static_cast<std::uint64_t>(abs64(way.x) | abs64(way.y));
  const int shift = std::max(0, 47 - static_cast<int>(std::bit_width(longest)));
  const Vector longer = {way.x * (std::int64_t{1} << shift), way.y * (std::int64_t{1} << shift)};
  const auto length = static_cast<std::uint64_t>(length_of(longer.x, longer.y));
  const auto aside = [&](std::int64_t v) {  // the distance times v / length
    const std::int64_t cosine_q48 = quotient_q48(static_cast<std::uint64_t>(abs64(v)), length);
    return times_q48(v < 0 ? -twice_aside_q6 : twice_aside_q6, cosine_q48);
  };
  // To the left of that direction: anticlockwise and less than half a turn, or neither.
  const std::int64_t side = clockwise == (radius_e7 < 0) ? 1 : -1;
  const auto halved = [](std::int64_t v_q6) { return (v_q6 + 64) >> 7; };
  centre = start;
  centre[plane.first] += halved(way.x * 64 - side * aside(longer.y));
  centre[plane.second] += halved(way.y * 64 + side * aside(longer.x));
  return true;
}

bool arc_fits(const ArcRequest& request) {
  if (!is_arc(request)) return false;
  const Ends ends = ends_of(request);
  const std::int64_t apart = abs64(ends.end_radius - ends.start_radius);
  if (apart <= radii_alike_e7) return true;
  return apart <= radii_apart_e7 && apart * radius_share <= ends.start_radius;
}

bool arc_has_radius(const ArcRequest& request) {
  const Ends ends = ends_of(request);
  return ends.start_radius > 0 && ends.end_radius > 0;
}

ArcRange arc_range(const ArcRequest& request) {
  const CurvePlane& plane = request.plane;
  const auto of_ends = [&](std::uint8_t axis) {
    Range range{request.start[axis], request.start[axis]};
    range.add(request.end[axis]);
    return range;
  };
  ArcRange range{of_ends(plane.first), of_ends(plane.second)};
  if (!is_arc(request)) return range;
  const Ends ends = ends_of(request);
  if (ends.start_radius == 0 || ends.end_radius == 0) return range;
  const Quarters passed = quarters_of(ends, request);
  const std::int64_t radius = std::max(ends.start_radius, ends.end_radius);
  const std::int64_t first = request.centre[plane.first], second = request.centre[plane.second];
  if (passed.right) range.first.add(first + radius);
  if (passed.up) range.second.add(second + radius);
  if (passed.left) range.first.add(first - radius);
  if (passed.down) range.second.add(second - radius);
  return range;
}

Division Arc::begin(const ArcRequest& request, std::int64_t other_way_e7) {
  const Vector straight = from_to(request.start, request.end, request.plane);
  const Division line = {1, sane(request.start, request.plane) && sane(request.end, request.plane)
                                ? length_of(length_of(straight.x, straight.y), other_way_e7)
                                : 0};
  if (!is_arc(request)) return line;
  const Ends ends = ends_of(request);
  if (ends.start_radius == 0 || ends.end_radius == 0) return line;

  const std::int64_t sweep = sweep_of(ends, request);
  const std::uint32_t pieces = pieces_of(ends, sweep, request.tolerance_e7);
  const std::int64_t turn = request.clockwise ? -sweep : sweep;
  angle_q48_.begin(0, turn, pieces);
  // The end turned back to the start: it differs from the start only by its length.
  const Vector start = finely(ends.start), back = turned(finely(ends.end), -turn);
  first_.begin(start.x, back.x, pieces);
  second_.begin(start.y, back.y, pieces);
  centre_ = {request.centre[request.plane.first], request.centre[request.plane.second]};
  return {pieces, length_of(length_in_plane(ends, sweep), other_way_e7)};
}

PlanePoint Arc::next(std::uint32_t pieces) {
  const Vector from_centre = {first_.next(pieces), second_.next(pieces)};
  const Vector v = turned(from_centre, angle_q48_.next(pieces));
  return {centre_.first_e7 + coarsely(v.x), centre_.second_e7 + coarsely(v.y)};
}

}  // namespace lamplock::program
