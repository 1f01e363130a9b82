// NURBS (G5.2, G5.3): rational B-splines over uniform knots that begin and end at their first and
// last control points.
//
// In:  control points with weights in the plane, and the order (the degree plus 1).
// Out: ends of the pieces in the plane; curve.hpp adds the other axes.
// Who: curve.hpp when a NURBS begins and for each of its pieces. A point takes some thousand cycles
//      by its order (estimated); the begin makes four points for each piece, two or three times.
//
// Knots are those of LinuxCNC: 0 (order times), 1, 2, .. n - order + 1 (order times) for n control
// points. A point is made by de Boor's algorithm in the form for rational curves (Farin, "Curves
// and Surfaces for CAGD", chapter 13): each step divides an edge of the control polygon by a ratio
// that contains the weights. So every step is between its points, whatever the weights are.
//
// Division: every span between two knots has the same number of pieces. The pieces are measured at
// quarters of their parameter; the number is raised until none of these points is farther from its
// chord than the tolerance, in proportion to the root of the distance. The quarters are also the
// polygon whose length is that of the curve.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/program/curves/shape.hpp"

namespace lamplock::program {

/// A control point. Weights are whole multiples of 10^-6.
struct NurbsPoint {
  PlanePoint place;
  std::uint32_t weight_e6;
};

/// The curve of a block from G5.2 to G5.3.
class NurbsPoints {
 public:
  static constexpr std::uint32_t capacity = 16;
  static constexpr std::uint32_t min_order = 2, max_order = 6;
  /// Limits of weights: 0.01 to 100.
  static constexpr std::uint32_t min_weight_e6 = 10'000, max_weight_e6 = 100'000'000;

  std::array<NurbsPoint, capacity> points;
  std::uint32_t count;
  std::uint32_t order;
};

/// Start and end are the places of the first and the last control point.
struct NurbsRequest {
  Place start, end;
  const NurbsPoints* control;  ///< until the last piece was returned
  CurvePlane plane;
  std::int64_t tolerance_e7;
};

/// The shape. A plain struct without initial values, because it lives in the union of Curve.
class Nurbs {
 public:
  /// Pieces, and the length including `other_way_e7` of the axes outside the plane.
  Division begin(const NurbsRequest& request, std::int64_t other_way_e7);
  /// End of the next piece, not for the last one.
  PlanePoint next(std::uint32_t pieces);

 private:
  struct Measure {
    std::int64_t distance_e7;  ///< the largest from a chord
    std::int64_t length_e7;
  };
  std::uint32_t spans() const { return control_->count - control_->order + 1; }
  std::uint32_t knot(std::uint32_t i) const;
  PlanePoint at(std::uint32_t span, std::uint32_t t_q30) const;
  PlanePoint place(std::uint32_t step, std::uint32_t steps_a_span) const;
  Measure measure(std::uint32_t pieces_a_span) const;

  const NurbsPoints* control_;
  std::uint32_t pieces_a_span_, done_;
};

}  // namespace lamplock::program
