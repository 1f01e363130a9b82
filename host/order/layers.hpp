// Layers of a cloud, lowest first. Comes in: a cloud. Goes out: the cloud sorted by layers and
// where each begins. Called by every ordering that goes layer by layer.
//
// A point is shadowed only by higher ones, so no layer can shadow one above it, and only the order
// inside a layer has to be looked after. In a layer thinner than the smallest distance of two
// points times the cosine of the half angle no point shadows another.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "host/points/point.hpp"

namespace lamplock::order {

/// Where each layer begins in a cloud sorted by layers; one more entry for the end.
using Starts = std::vector<std::size_t>;

/// Sorts by layers of a thickness, stable within each. Not for an empty cloud.
Starts sort_into_layers(points::PointCloud& cloud, double layer_mm);

/// The same with a thickness that suits the cloud: the planes it lies on, if each holds several
/// points as after slicing; else what its points' distances to the nearest other allow.
Starts sort_into_fitting_layers(points::PointCloud& cloud, double tangent);

/// Median distance of a point to the nearest other, asked of 20 000 in the middle of a cloud that
/// is sorted by height; 0 if half of them are doubled.
double usual_spacing_mm(const points::PointCloud& cloud);

/// What is done with the points of one layer; may be called from several threads at once.
using LayerWork = std::function<void(std::span<points::Point>)>;

/// Does it with every layer, in `threads` threads (0: as many as the processor has). `progress` is
/// called in the caller's thread only, with the number of points done, and may throw.
void for_each_layer(points::PointCloud& cloud, const Starts& starts, unsigned threads,
                    const LayerWork& work, const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
