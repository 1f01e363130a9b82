// Points of a job whose input is not at hand. Who: `send`, `job --show`.
#pragma once

#include "host/job/job.hpp"
#include "host/points/point.hpp"

namespace lamplock::cli {

/// Where the targets of a job lie, or the ends of its lines [mm].
points::PointCloud points_of(const job::Job& job);

}  // namespace lamplock::cli
