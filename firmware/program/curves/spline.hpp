// Cubic splines (G5): equal steps of the parameter, as many as the tolerance requires.
//
// In:  four control points of a Bezier curve in the plane.
// Out: ends of the pieces in the plane; curve.hpp adds the other axes.
// Who: curve.hpp when a spline begins, 7 000 to 32 000 cycles of the RP2040, most of them for the
//      length, and for each of its pieces, 1700 cycles with 18 products of 32 x 32 bits.
//
// B(t) = a + b t + c t^2 + d t^3 with integer coefficients, computed separately for each t = i/n,
// which is an IntegerDivider of 48 bits: a point is less than 1 e7 beside the true curve.
//
// Division: a chord over h of the parameter deviates from the curve by h^2/8 |B''| at most, and
// |B''| is at most that at one of the ends, 6 |P2 - 2 P1 + P0| or 6 |P3 - 2 P2 + P1|. So n^2 >= 3/4
// M / e with the larger M of the two. At most 65536 pieces are made, however small the tolerance: a
// spline over 20 m is then followed to 3 10^-5 mm. A straight line that is run evenly is one piece,
// and so is a spline with a coordinate beyond 7 km; cusps and loops need no special case.
#pragma once

#include <cstdint>

#include "firmware/program/curves/shape.hpp"

namespace lamplock::program {

/// All in machine coordinates; of the control points only the axes of the plane are used.
struct SplineRequest {
  Place start, first_control, second_control, end;
  CurvePlane plane;
  std::int64_t tolerance_e7;
};

inline constexpr std::uint32_t max_spline_pieces = 65536;

/// What the spline reaches on an axis, within 4 10^-7 mm or 10^-12 of its size. Up to 20 000
/// cycles, if it goes beyond both of its ends.
[[gnu::cold]] Range spline_range(const SplineRequest& request, std::uint8_t axis);

/// The shape. A plain struct without initial values, because it lives in the union of Curve.
class Spline {
 public:
  /// Pieces, and the length including `other_way_e7` of the axes outside the plane.
  Division begin(const SplineRequest& request, std::int64_t other_way_e7);
  /// End of the next piece, not for the last one.
  PlanePoint next(std::uint32_t pieces);

 private:
  friend Range spline_range(const SplineRequest& request, std::uint8_t axis);

  /// a + b t + c t^2 + d t^3.
  struct Cubic {
    std::int64_t a, b, c, d;  ///< all but a in 2^-4 e7
  };
  static Cubic cubic_of(const SplineRequest& request, std::uint8_t axis);
  static std::int64_t at(const Cubic& cubic, std::int64_t t_q48);

  IntegerDivider t_q48_;
  Cubic first_, second_;
};

}  // namespace lamplock::program
