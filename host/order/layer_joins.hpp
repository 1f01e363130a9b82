// Joins the pieces of layers with short jumps. In: an order, layer by layer, that keeps the shadow
// rule. Out: an order that keeps it and needs no more beats by the model. Called once for a cloud,
// after the tours of its layers.
//
// Where a layer consists of parts far from each other, such as the legs of a figure, an order by
// layers needs a jump of many beats in each. The rule allows better: a leg may be fired upwards
// until it would shadow another. So the order is cut at its jumps and at the ends of layers, and
// the next piece is the nearest one that shadows no remaining point.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/order/beat_model.hpp"

namespace lamplock::order {

/// Minimum length of a jump for this cloud and this machine, mm. The cloud must be sorted by
/// height.
double jump_mm(const geometry::PointCloud& cloud, const BeatModel& model);

/// `starts` as in layers.hpp, of layers or of parts of them (clusters.hpp); `jump` as above.
/// Progress is the number of points done. The machine starts at `from`.
void join_pieces(geometry::PointCloud& order, const std::vector<std::size_t>& starts,
                 const geometry::Point& from, double jump, const BeatModel& model, double tangent,
                 const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
