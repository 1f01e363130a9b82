// Dividing curves ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects
// in glass": curves sampled at a distance, layers, twist). In: drawn curves in mm. Out: points on
// them at equal arc length, layer by layer from below, path by path. Called by the command line;
// weld() follows, because curves may share vertices.
#pragma once

#include "host/geometry/point.hpp"
#include "host/model/curves.hpp"

namespace lamplock::points {

struct DivideOptions {
  double spacing_mm = 0.1;  ///< wanted distance along the curve
  /// Open curves get a point at each end; otherwise their outermost points are half a distance from
  /// the ends.
  bool end_points = true;
  int layers = 1;
  double layer_mm = 0.1;  ///< from layer to layer, along z
  /// In layer k the first point of a closed curve is shifted along it by k times this, mm.
  double twist_mm = 0;
};

/// A curve of length L gets n = max(1, floor(L / spacing_mm)) points at distance L / n if it is
/// closed, beginning at its start; n + 1 from end to end if it is open and has end points, n
/// without. Points of the drawing stay points. Layers are centred on the drawing's own z. Throws
/// Error (bad_input) for options out of range or too many points.
geometry::PointCloud divide(const model::Curves& curves, const DivideOptions& options);

}  // namespace lamplock::points
