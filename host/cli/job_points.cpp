#include "host/cli/job_points.hpp"

#include <algorithm>

#include "host/cli/board_files.hpp"

namespace lamplock::cli {

points::PointCloud points_of(const job::Job& job) {
  const PerAxis<double> resolution = steps_per_mm(job.settings);
  points::PointCloud cloud(job.targets.size());
  std::transform(job.targets.begin(), job.targets.end(), cloud.begin(),
                 [&resolution](const motion::Target& target) {
                   return points::Point{target.steps[0] / resolution[0],
                                        target.steps[1] / resolution[1],
                                        target.steps[2] / resolution[2]};
                 });
  return cloud;
}

}  // namespace lamplock::cli
