// Saves beats of a whole order by annealing (S. Kirkpatrick, C. D. Gelatt, M. P. Vecchi,
// "Optimization by simulated annealing", Science, 1983). In: an order that keeps the shadow rule.
// Out: an order of the same points that keeps it and takes no more beats by the model. Called once
// for a cloud, last.
//
// The search for tours (local_search.hpp) stays in its layer and stops where no exchange saves
// beats. Here points change places across layers too, unless one would come after a point that
// shadows it, and exchanges that waste a little are accepted too, ever fewer of them. The order is
// processed in stretches of some thousand points with fixed ends: so stretches are independent of
// each other, and distant points are never compared. A stretch with which the whole order takes
// more beats, because its real entry speed differs from the planned one, is undone.
#pragma once

#include <cstddef>
#include <functional>

#include "host/geometry/point.hpp"
#include "host/order/beat_model.hpp"

namespace lamplock::order {

/// Evaluates the model `asked_a_point` times per point, about 10 us each, less often where few
/// beats are wasted. Deterministic for any number of threads (0: as many as the processor has).
/// `progress` gets the number of points done and may throw.
void anneal(geometry::PointCloud& order, const BeatModel& model, double tangent,
            double asked_a_point, unsigned threads,
            const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
