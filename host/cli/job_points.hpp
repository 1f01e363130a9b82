// Points of a job whose input is not at hand. Who: `send`, `job --show`.
#pragma once

#include "host/job/job.hpp"
#include "host/points/point.hpp"

namespace lamplock::cli {

/// Where the points of a job lie in the glass, or the ends of its lines [mm]; pauses have none.
points::PointCloud points_of(const job::Job& job);

}  // namespace lamplock::cli
