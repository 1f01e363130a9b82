#include "host/run/estimate_job.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "host/estimate/estimate.hpp"
#include "host/file/output_files.hpp"
#include "host/file/staged_file.hpp"
#include "host/number_text.hpp"
#include "host/report/page.hpp"
#include "host/run/job_run.hpp"
#include "host/run/pause_beats.hpp"
#include "host/run/read_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/shell_text.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::run {
namespace {

/// A job as `send` would run it, or made as `engrave` would make it.
PreparedJob job_of(const EstimateOptions& options, Frontend& frontend) {
  const JobRequest& request = options.request;
  if (is_job_file(request.input)) return read_prepared_job(request.input);
  return prepare_job(request, false, ask_origin(request.origin, nullptr), frontend);
}

/// The estimate in the form of a run, as far as a run can be predicted. Memory has no room for two
/// copies of ten million points.
report::JobRun run_of(PreparedJob prepared, const EstimateOptions& options,
                      estimate::Estimate estimate) {
  const auto before = static_cast<std::ptrdiff_t>(prepared.job.points_before(options.job.from));
  geometry::PointCloud points_before(prepared.points.begin(), prepared.points.begin() + before);
  prepared.points.erase(prepared.points.begin(), prepared.points.begin() + before);
  report::JobRun run =
      begin_run(prepared, std::move(prepared.points), "estimate", options.job.from);
  run.points_before = std::move(points_before);
  run.shots_fired = estimate.shots;
  run.points_fired = run.points.size();
  run.foreseen_beats = std::move(estimate.beat_of_shot);
  run.beats = estimate.beats;
  run.beats_before = estimate.beats_before;
  run.time_s = estimate.time_s;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    run.beats_by_reason[std::string(beat_reason_names[i])] = estimate.beats_by_reason[i];
  count_pauses(prepared.job, options.job.from, prepared.job.size(), run.beats_by_reason,
               run.beats_outside);
  return run;
}

estimate::Estimate estimate_prepared(const PreparedJob& prepared, const EstimateOptions& options,
                                     Frontend& frontend) {
  const std::unique_ptr<Progress> progress =
      frontend.progress("estimating", prepared.job.size(), options.job.from);
  estimate::EstimateOptions wanted;
  wanted.input = prepared.input;
  wanted.first = options.job.from;
  wanted.fired = options.job.fired;
  wanted.job_speed = options.job.job_speed;
  wanted.progress = [&progress](std::size_t done) { progress->update(done); };
  return estimate::estimate_job(prepared.job, wanted);
}

void write_page_file(const report::Report& report, const report::JobRun& run,
                     const std::string& file, Frontend& frontend) {
  if (file.empty()) return;
  write_whole(file,
              [&](const std::filesystem::path& path) { report::write_page(report, run, path); });
  frontend.phase("page", file);
}

}  // namespace

Estimated estimate_job(const EstimateOptions& options, Frontend& frontend) {
  check_distinct({{"--page", options.page}}, input_files(options.request));
  if (!options.page.empty()) check_target(options.page);
  PreparedJob prepared = job_of(options, frontend);
  prepared.job.header.dry = false;
  prepared.making.command = shell_text(options.job.command);
  subtract_fired(prepared, options.job);
  estimate::Estimate estimate = estimate_prepared(prepared, options, frontend);
  const double seconds = estimate.time_before_s + estimate.time_s;
  const report::JobRun run = run_of(std::move(prepared), options, std::move(estimate));
  Estimated estimated{report::evaluate(run), seconds};
  frontend.phase("estimate", count_text(estimated.report.points, "point"));
  write_page_file(estimated.report, run, options.page, frontend);
  return estimated;
}

}  // namespace lamplock::run
