// The order of engraving. Comes in: a cloud in mm. Goes out: the same points in the order in which
// they are to be fired. Called once per job, before the job is made.
//
// The beam comes from above and a defect shadows what lies under it, so lower layers come first
// ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in glass").
// Within a layer the order is free and the cost is wasted lamp periods: besides short steps these
// need even ones, so a tour is judged by sum |d| + weight * sum |change of d|.
#pragma once

#include <functional>

#include "host/points/point.hpp"

namespace lamplock::order {

enum class Ordering {
  given,  // as it came
  layers  // lowest layer first, a short and even tour in each
};

struct OrderOptions {
  /// Thickness of a layer. Thinner than the smallest distance of two points times the cosine of
  /// half the focusing angle, no two points of a layer can shadow each other.
  double layer_mm = 0.1;
  /// Where the machine stands before the first point.
  points::Point start{};
  /// Called in the caller's thread now and then with the part done, 0..1; may throw to give up.
  std::function<void(double)> progress{};
  /// 0: as many as the processor has. The result does not depend on it.
  unsigned threads = 0;
};

/// A permutation of `cloud`, deterministic. Time n log n, memory linear. Throws Error (bad_input)
/// if the layer thickness is not positive. Coordinates must be finite.
points::PointCloud order(points::PointCloud cloud, Ordering ordering,
                         const OrderOptions& options = {});

}  // namespace lamplock::order
