// Parts of layers that lie far from each other, such as the legs of a figure. Comes in: a cloud
// sorted by layers. Goes out: the same, part by part inside each layer. Called once for a cloud, so
// that each part gets a tour of its own.
#pragma once

#include "host/order/layers.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// Points closer than `apart_mm` are of one part, and so are those of a layer that might shadow
/// each other. Keeps the order inside a part; returns where each part begins. Time n log n.
Starts split_into_parts(points::PointCloud& cloud, const Starts& starts, double apart_mm,
                        double tangent);

}  // namespace lamplock::order
