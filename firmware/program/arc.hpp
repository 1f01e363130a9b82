// Arcs and helices (G2, G3): equal pieces, as few as the tolerance allows.
//
// In:  start, end and centre, or a radius from which centre_of_radius() finds the centre.
// Out: ends of the pieces in the plane; curve.hpp adds the other axes.
// Called by curve.hpp when an arc begins, 18 000 to 23 000 cycles of the RP2040, and for each of
// its pieces, 2500 cycles with 28 products of 32 x 32 bits (2700 where code is compiled for size).
//
// Point i of n is the centre plus the vector to the start, turned by i/n of the angle between
// start and end, with its sine and cosine computed anew for each (angle.hpp). Nothing is carried
// from point to point but EvenWalks, which are exact, so there is no drift. Where the radius at the
// end is another one the vector grows evenly with the angle: a spiral that ends at the end. A point
// is less than 1 e7 beside the true curve for radii up to 4 m.
//
// Division. A chord over the angle a leaves a circle by r (1 - cos(a/2)); the largest a that keeps
// the tolerance e is 2 atan2(sqrt(e (2r - e)), r - e), and as few equal pieces are made as are no
// larger. On a spiral a chord leaves the curve by a^2/8 |P''| at most, |P''|^2 <= r^2 + 4 r'^2, so
// that is taken for the radius. (The rule of the circle is looser than a^2/8 by a share of e/12r;
// tried on 400 000 narrow spirals, none used it up.)
//   * A tolerance below 5 10^-6 mm counts as that: 62832 pieces a turn at 4 m.
//   * A piece is never more than a quarter of a turn, however large the tolerance.
//   * Of more than `most_turns` further turns so many are made.
//   * There are 2^30 pieces at most: longer ones where that is not enough, which takes a radius
//     larger than the machine.
//
// Length. The way round grows with the radius and the way outwards does not, so a spiral is not as
// long as a place of it times the whole: 0.4 % at a radius that halves, 4 % at one that falls to
// nothing, which the radii of a hole of some um may do. Where they differ by more than a 16th its
// length is Simpson's rule over 16 parts: within 10^-5 down to a tenth of the radius, within 2
// 10^-4 always. Such an arc takes 17 roots of 128 bits more to begin.
//
// What is no arc (start or end is the centre, a coordinate beyond 7 km) becomes one straight piece.
// Start and end at the same place or in the same direction, seen from the centre: a full turn.
// "G-code Reference" of LinuxCNC, G2/G3, has arcs with both; the rule for radii that differ is
// grbl's (1.1, error 33).
#pragma once

#include <cstdint>

#include "firmware/program/shape.hpp"

namespace lamplock::program {

/// All in machine coordinates.
struct ArcRequest {
  Place start, end;
  Place centre;  ///< in the plane; its other axes mean nothing
  CurvePlane plane;
  bool clockwise;
  std::uint32_t turns;  ///< P word: 0 and 1 for none, 2 for a further full turn, ...
  std::int64_t tolerance_e7;
};

inline constexpr std::uint32_t most_turns = 9999;

/// Centre of an arc of given radius; a negative radius means the arc of more than half a turn. Its
/// axes outside the plane are those of the start. False: start and end are the same place or
/// farther apart than two radii (by more than 2 10^-6 mm, which is taken for rounding), the radius
/// is 0 or one of the coordinates beyond 7 km.
bool centre_of_radius(const Place& start, const Place& end, const CurvePlane& plane,
                      std::int64_t radius_e7, bool clockwise, Place& centre);

/// Whether the radii at both ends agree: within 0.005 mm, or within 0.5 mm and 0.1 % of the radius
/// at the start.
bool arc_fits(const ArcRequest& request);

/// The shape. A plain struct without initial values, because it lives in the union of Curve.
class Arc {
 public:
  /// Pieces, and the length including `other_way_e7` of the axes outside the plane.
  Division begin(const ArcRequest& request, std::int64_t other_way_e7);
  /// End of the next piece, not for the last one.
  PlanePoint next(std::uint32_t pieces);

 private:
  EvenWalk angle_q48_;       ///< from the start; negative = clockwise
  EvenWalk first_, second_;  ///< from the centre, not turned yet, 2^-7 e7
  PlanePoint centre_;
};

}  // namespace lamplock::program
