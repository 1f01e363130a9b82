// Saves beats of a whole order by annealing (S. Kirkpatrick, C. D. Gelatt, M. P. Vecchi,
// "Optimization by simulated annealing", Science, 1983). Comes in: an order that keeps the shadow
// rule. Goes out: an order of the same points that keeps it and takes no more beats by the model.
// Called once for a cloud, last.
//
// The search for tours (local_search.hpp) stays in its layer and stops where no exchange saves
// anything. Here points change places across layers too, as long as none gets behind one that
// shadows it, and exchanges that waste a little are made as well, ever fewer of them. The order is
// taken a stretch of some thousand points at a time, whose ends stay as they are: so stretches are
// independent of each other, and points that cannot meet are never compared. A stretch with which
// the whole order would take more beats, since it is not come into at the speed it was planned for,
// is taken back.
#pragma once

#include <cstddef>
#include <functional>

#include "host/order/beat_model.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// The model is asked `asked_a_point` times, about 10 us each, less often where few beats are
/// wasted. Deterministic, whatever the number of threads (0: as many as the processor has).
/// `progress` is told points done and may throw.
void anneal(points::PointCloud& order, const BeatModel& model, double tangent, double asked_a_point,
            unsigned threads, const std::function<void(std::size_t)>& progress);

}  // namespace lamplock::order
