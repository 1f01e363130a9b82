// Layers of a cloud, lowest first. In: a cloud. Out: the cloud sorted by layers, and the begin of
// each. Called by every ordering by layers.
//
// A point is shadowed only by higher ones, so a layer never shadows one above it, and the shadow
// rule concerns only the order inside a layer. In a layer thinner than the smallest distance of two
// points times the cosine of the half angle no point shadows another.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::order {

/// Begin of each layer in a cloud sorted by layers; one more entry for the end.
using Starts = std::vector<std::size_t>;

/// Sorts by layers of a thickness, stable within each. Not for an empty cloud.
Starts sort_into_layers(geometry::PointCloud& cloud, double layer_mm);

/// The same with a thickness for the cloud: one layer for each plane of points, if planes hold
/// several points, as after slicing; otherwise from the distances of points to their nearest other.
Starts sort_into_fitting_layers(geometry::PointCloud& cloud, double tangent);

/// Median distance of a point to the nearest other, for 20 000 points in the middle of a cloud that
/// is sorted by height; 0 if half of them coincide with another.
double usual_spacing_mm(const geometry::PointCloud& cloud);

/// Processes the points of one layer; may be called from several threads at once.
using LayerWork = std::function<void(std::span<geometry::Point>)>;

/// Processes every layer, in `threads` threads (0: as many as the processor has). `progress` is
/// called in the caller's thread only, with the number of points done, and may throw.
void for_each_layer(geometry::PointCloud& cloud, const Starts& starts, unsigned threads,
                    const LayerWork& work, const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
