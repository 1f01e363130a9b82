// Arcs and helices (G2, G3): equal pieces, as few as the tolerance allows.
//
// In:  start, end and centre, or a radius from which centre_of_radius() finds the centre.
// Out: ends of the pieces in the plane; curve.hpp adds the other axes.
// Who: curve.hpp when an arc begins, 18 000 to 23 000 cycles of the RP2040, and for each of its
//      pieces, 2500 cycles with 28 products of 32 x 32 bits (2700 where code is compiled for size).
//
// Point i of n is the centre plus the vector to the start, turned by i/n of the angle between start
// and end, with sine and cosine computed separately for each point (angle.hpp). Only EvenWalks,
// which are exact, carry values from point to point, so there is no drift. If the radius at the end
// differs the vector grows evenly with the angle: a spiral that ends at the end. A point is less
// than 1 e7 beside the true curve for radii up to 4 m.
//
// Division. A chord over the angle a deviates from a circle by r (1 - cos(a/2)); the largest a that
// keeps the tolerance e is 2 atan2(sqrt(e (2r - e)), r - e), and the arc is divided into the fewest
// equal pieces that are not larger. On a spiral a chord deviates by a^2/8 |P''| at most, |P''|^2 <=
// r^2 + 4 r'^2, so that is used as the radius. (The rule of the circle is looser than a^2/8 by a
// share of e/12r; of 400 000 narrow spirals tried, none used it up.)
//   * A tolerance below 5 10^-6 mm counts as that: 62832 pieces a turn at 4 m.
//   * A piece is never more than a quarter of a turn, however large the tolerance.
//   * At most `max_turns` further turns are made.
//   * There are 2^30 pieces at most, longer ones if that is not enough, which needs a radius larger
//     than the machine.
//
// Length. The distance round grows with the radius and the distance outwards does not, so the
// length of a spiral is not that of one of its places times the whole: 0.4 % error at a radius that
// halves, 4 % at one that falls to zero, which the radii of a hole of some um may do. Where the
// radii differ by more than a 16th the length is Simpson's rule over 16 parts: within 10^-5 down to
// a tenth of the radius, within 2 10^-4 always. Such an arc needs 17 more roots of 128 bits to
// begin.
//
// A request that is no arc (start or end is the centre, a coordinate beyond 7 km) becomes one
// straight piece. Start and end at the same place or in the same direction, seen from the centre: a
// full turn. "G-code Reference" of LinuxCNC, G2/G3, has arcs with both; the rule for radii that
// differ is grbl's (1.1, error 33).
#pragma once

#include <cstdint>

#include "firmware/program/curves/shape.hpp"

namespace lamplock::program {

/// All in machine coordinates.
struct ArcRequest {
  Place start, end;
  Place centre;  ///< in the plane; its other axes are ignored
  CurvePlane plane;
  bool clockwise;
  std::uint32_t turns;  ///< P word: 0 and 1 for none, 2 for a further full turn, ...
  std::int64_t tolerance_e7;
};

inline constexpr std::uint32_t max_turns = 9999;

/// Centre of an arc of given radius; a negative radius means the arc of more than half a turn. Its
/// axes outside the plane are those of the start. A radius that is less than half the distance of
/// start and end by up to 0.00127 mm counts as that half: programs have half circles with rounded
/// numbers. False: start and end are the same place or farther apart, the radius is 0 or one of the
/// coordinates beyond 7 km.
bool centre_of_radius(const Place& start, const Place& end, const CurvePlane& plane,
                      std::int64_t radius_e7, bool clockwise, Place& centre);

/// Whether the radii at both ends agree: within 0.005 mm, or within 0.5 mm and 0.1 % of the radius
/// at the start.
bool arc_fits(const ArcRequest& request);

/// False if the centre is the start or the end: no direction belongs to such an arc.
bool arc_has_radius(const ArcRequest& request);

/// What the arc reaches on both axes of its plane, within 2 10^-7 mm; of a spiral as if all of it
/// had the larger radius. A few hundred cycles and two roots of 128 bits.
struct ArcRange {
  Range first, second;
};
[[gnu::cold]] ArcRange arc_range(const ArcRequest& request);

/// The shape. A plain struct without initial values, because it lives in the union of Curve.
class Arc {
 public:
  /// Pieces, and the length including `other_way_e7` of the axes outside the plane.
  Division begin(const ArcRequest& request, std::int64_t other_way_e7);
  /// End of the next piece, not for the last one.
  PlanePoint next(std::uint32_t pieces);

 private:
  IntegerDivider angle_q48_;       ///< from the start; negative = clockwise
  IntegerDivider first_, second_;  ///< from the centre, not turned yet, 2^-7 e7
  PlanePoint centre_;
};

}  // namespace lamplock::program
