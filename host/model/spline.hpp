// B-splines, rational or not: soundness and evaluation (Piegl and Tiller, "The NURBS Book", 1997;
// de Boor's algorithm).
//
// In:  a spline. Out: what is wrong with it; position and derivative.
// Who: the readers of curves before they keep one; motion_at(), arc length and flattening.
#pragma once

#include <string>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// CAD programs write 1 to 5, some formats allow this much.
inline constexpr int highest_degree = 25;

/// What is wrong with the spline, nothing if it can be evaluated. Knots that differ by rounding
/// alone are made equal.
std::string fault_of(Spline& spline);

/// Position and derivative; outside the range of the spline those of its ends.
Motion spline_motion(const Spline& spline, double parameter);

/// The parameters between which the spline is one smooth piece, ends included, rising.
std::vector<double> breaks_of(const Spline& spline);

/// The Bezier curve of these poles, at least two, from 0 to 1.
Spline bezier(std::vector<points::Point> poles);

}  // namespace lamplock::model
