// B-splines, rational or not: check and evaluation (Piegl and Tiller, "The NURBS Book", 1997; de
// Boor's algorithm).
//
// In:  a spline. Out: its fault; position and derivative.
// Who: the readers of curves before they store one; motion_at(), arc length and flattening.
#pragma once

#include <string>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// CAD programs write 1 to 5, some formats allow this much.
inline constexpr int max_degree = 25;

/// The fault of the spline, empty if it can be evaluated. Knots that differ only by rounding are
/// made equal.
std::string fault_of(Spline& spline);

/// Position and derivative; outside the range of the spline those at its ends.
Motion spline_motion(const Spline& spline, double parameter);

/// The ascending parameters, ends included, between which the spline is one smooth piece.
std::vector<double> breaks_of(const Spline& spline);

/// The Bezier curve of these poles, at least two, from 0 to 1.
Spline bezier(std::vector<geometry::Point> poles);

}  // namespace lamplock::model
