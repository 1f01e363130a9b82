// Splits layers into parts far from each other, such as the legs of a figure. In: a cloud sorted by
// layers. Out: the same, part by part inside each layer. Called once for a cloud, so that each part
// gets a tour of its own.
#pragma once

#include "host/geometry/point.hpp"
#include "host/order/layers.hpp"

namespace lamplock::order {

/// Points closer than `apart_mm` are in one part, and so are those of a layer that might shadow
/// each other. Keeps the order inside a part; returns the begin of each part. Time n log n.
Starts split_into_parts(geometry::PointCloud& cloud, const Starts& starts, double apart_mm,
                        double tangent);

}  // namespace lamplock::order
