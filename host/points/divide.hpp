// Dividing curves ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects
// in glass": curves sampled at a distance, layers, twist). Comes in: drawn curves in mm. Goes out:
// points on them at equal arc length, layer by layer from below, path by path. Called by the
// command line; weld() follows, because curves may share vertices.
#pragma once

#include "host/model/curves.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

struct DivideOptions {
  double spacing_mm = 0.1;  ///< wanted distance along the curve
  /// Open curves get a point at each end; otherwise their outermost points are half a distance from
  /// the ends.
  bool end_points = true;
  int layers = 1;
  double layer_mm = 0.1;  ///< from layer to layer, along z
  /// Layer k starts its closed curves k times this further along, mm.
  double twist_mm = 0;
};

/// A curve of length L gets n = max(1, floor(L / spacing_mm)) points at distance L / n if it is
/// closed, from its start on and none doubled; n + 1 from end to end if it is open and has end
/// points, n without. Points of the drawing stay points. Layers are stacked round the drawing's own
/// z. Throws Error (bad_input) for options out of range or too many points.
PointCloud divide(const model::Curves& curves, const DivideOptions& options);

}  // namespace lamplock::points
