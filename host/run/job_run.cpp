#include "host/run/job_run.hpp"

#include <utility>

#include "host/run/board_files.hpp"
#include "host/run/mode_name.hpp"

namespace lamplock::run {

report::JobRun begin_run(const PreparedJob& prepared, geometry::PointCloud points,
                         const std::string& board, std::size_t from) {
  const job::Job& job = prepared.job;
  report::JobRun run;
  run.input = prepared.input;
  run.mode = mode_name(job.header.mode);
  run.board = board;
  run.making = prepared.making;
  run.first_number = from;
  run.points = std::move(points);
  run.shots_ordered.reserve(run.points.size());
  for (std::size_t i = from; i < job.targets.size(); ++i) {
    if (job.is_pause(i))
      run.pauses.push_back(static_cast<std::uint32_t>(run.shots_ordered.size()));
    else
      run.shots_ordered.push_back(job.header.dry ? 0 : job.targets[i].shots);
  }
  run.shots_known = false;
  run.refraction = job.refraction;
  run.warnings = prepared.warnings;
  run.settings = job.settings;
  run.steps_per_mm = steps_per_mm(run.settings);
  return run;
}

}  // namespace lamplock::run
