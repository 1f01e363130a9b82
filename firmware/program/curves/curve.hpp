// Divides curves into straight pieces: one interface for all kinds.
//
// In:  a request of the interpreter: the kind of curve, its points in machine coordinates, and the
//      maximum distance of a straight piece from it.
// Out: the ends of the pieces, one at a time, as the planner has room for them; the last one is
//      exactly the programmed end.
// Who: the interpreter, main loop; budgets are in arc.hpp and spline.hpp.
//
// The axes outside the plane move evenly from piece to piece. The length counts all axes, also a
// rotary one by its degrees, as the planner's lines do.
//
// A further kind of curve, here a conic, is one header and its source:
//   * a request, which must have `start`, `end` and `plane`;
//   * a class without initial values (it lives in a union) with
//       Division begin(const ConicRequest&, std::int64_t other_way_e7);
//       PlanePoint next(std::uint32_t pieces);
//     begin() gets the distance of the axes outside the plane, for the length, and returns from 1
//     to 2^31 - 1 pieces; next() is called for every piece but the last;
// and here: a line in `Kind`, in the union, in next(), and a begin_conic() of one line.
#pragma once

#include <cstdint>

#include "firmware/program/curves/arc.hpp"
#include "firmware/program/curves/nurbs.hpp"
#include "firmware/program/curves/shape.hpp"
#include "firmware/program/curves/spline.hpp"

namespace lamplock::program {

/// One curve at a time; a new one replaces the rest of the last one. Coordinates of all axes must
/// be within 7 km (shape.hpp); in the plane, a curve beyond becomes a straight line.
class Curve {
 public:
  Curve() : arc{} {}

  void begin_arc(const ArcRequest& request);
  void begin_spline(const SplineRequest& request);
  [[gnu::cold]] void begin_nurbs(const NurbsRequest& request);
  /// Drops the rest of the curve.
  void stop() { left_ = 0; }

  /// Whether there is a piece left.
  bool active() const { return left_ != 0; }
  /// End of the next straight piece; false if there are no more.
  bool next(Place& end);
  /// Length of the whole curve, within 0.1 %.
  std::int64_t length_e7() const { return length_e7_; }
  std::uint32_t pieces() const { return pieces_; }

 private:
  enum class Kind : std::uint8_t { arc, spline, nurbs };

  template <class Shape, class Request>
  void begin(Kind kind, Shape& shape, const Request& request);
  PlanePoint next_in_plane();

  union {
    Arc arc;
    Spline spline;
    Nurbs nurbs;
  };
  IntegerDivider normal_{}, rotary_{};
  Place end_{};
  std::int64_t length_e7_ = 0;
  std::uint32_t pieces_ = 0, left_ = 0;
  CurvePlane plane_{0, 1, 2};
  Kind kind_ = Kind::arc;
};

}  // namespace lamplock::program
