#include "host/run/job_points.hpp"

#include "host/run/board_files.hpp"

namespace lamplock::run {

geometry::PointCloud points_of(const job::Job& job) {
  const PerAxis<double> resolution = steps_per_mm(job.settings);
  const auto point = [&](const StepPosition& steps) {
    return job.refraction.glass(
        {steps[0] / resolution[0], steps[1] / resolution[1], steps[2] / resolution[2]});
  };
  geometry::PointCloud cloud;
  cloud.reserve(job.size());
  for (std::size_t i = 0; i < job.targets.size(); ++i)
    if (!job.is_pause(i)) cloud.push_back(point(job.targets[i].steps));
  for (const job::Line& line : job.rows.lines) cloud.push_back(point(line.to.steps));
  return cloud;
}

}  // namespace lamplock::run
