// Points of a job whose input is not at hand. Who: `send`, `job --show`.
#pragma once

#include "host/geometry/point.hpp"
#include "host/job/job.hpp"

namespace lamplock::run {

/// Where the points of a job lie in the glass, or the ends of its lines [mm]; pauses have none.
geometry::PointCloud points_of(const job::Job& job);

}  // namespace lamplock::run
