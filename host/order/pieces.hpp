// Puts the pieces of layers together with short jumps. Comes in: an order, layer by layer, that
// keeps the shadow rule. Goes out: an order that keeps it and needs no more beats by the model.
// Called once for a cloud, after the tours of its layers.
//
// Where a layer consists of parts far from each other, such as the legs of a figure, going layer by
// layer costs a jump of many beats in each. The rule does not ask for that: a leg may be gone up
// until it would shadow another. So the order is cut at its jumps and at the ends of layers, and
// the nearest piece that shadows nothing left comes next.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "host/order/beat_model.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// A way that is long for this cloud and this machine, mm. The cloud must be sorted by height.
double jump_mm(const points::PointCloud& cloud, const BeatModel& model);

/// `starts` as in layers.hpp, of layers or of parts of them (parts.hpp); `jump` as above. Progress
/// is told as points done. The machine comes from `from`.
void join_pieces(points::PointCloud& order, const std::vector<std::size_t>& starts,
                 const points::Point& from, double jump, const BeatModel& model, double tangent,
                 const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
