#include "host/run/job_run.hpp"

#include <algorithm>
#include <utility>

#include "host/link/job_result.hpp"
#include "host/run/board_files.hpp"
#include "host/run/continue_command.hpp"
#include "host/run/mode_name.hpp"
#include "host/units.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::run {
namespace {

/// Index, in the points of the run, of the first point that is not done, by the board's last word:
/// its status at rest, or its mark of a restart.
std::size_t points_done(const job::Job& job, std::size_t from, const link::JobResult& result) {
  const std::size_t next = std::clamp(result.rest.first, from, job.size());
  return job.points_before(next) - job.points_before(from);
}

/// Flashes ordered for the items of the run that are done, without those of earlier runs.
std::uint64_t flashes_done(const job::Job& job, const BoardOptions& options,
                           const link::JobResult& result) {
  const std::size_t next = std::min(result.rest.first, job.targets.size());
  std::uint64_t flashes = 0;
  for (std::size_t i = options.from; i < next; ++i) flashes += job.targets[i].shots;
  return next > options.from ? flashes - std::min<std::uint64_t>(flashes, options.fired) : 0;
}

/// Counters of the board at its last report. After a restart they are older than its mark of the
/// first point not fired: shots and beats of the points between follow from the job.
void add_counters(const PreparedJob& prepared, const BoardOptions& options,
                  const link::JobResult& result, report::JobRun& run) {
  const wire::Status& status = result.status;
  const job::Job& job = prepared.job;
  const std::uint64_t done = job.header.dry ? 0 : flashes_done(job, options, result);
  const std::uint64_t unreported = done - std::min<std::uint64_t>(done, status.shots);
  run.shots_fired = status.shots + unreported;
  run.points_fired = job.header.dry ? 0 : points_done(job, options.from, result);
  run.beats = status.beats + unreported;
  run.beats_before = status.beats_before;
  run.time_s =
      static_cast<double>(run.beats) / in_units(run.settings, settings::Id::lamp_frequency);
  for (std::size_t i = 0; i < beat_reason_count; ++i) {
    const std::string reason(beat_reason_names[i]);
    run.beats_by_reason[reason] = status.beats_by_reason[i];
    run.beats_outside[reason] = status.beats_outside[i];
  }
  run.beats_by_reason[std::string(
      beat_reason_names[static_cast<std::size_t>(BeatReason::fired)])] += unreported;
  run.checks = {status.shots_made, status.shots_not_made, status.repeats};
  run.link = {result.resent, result.bad_frames + status.link.bad_frames, result.reconnects};
}

void add_end(const PreparedJob& prepared, const BoardOptions& options, const JobOutcome& outcome,
             report::JobRun& run) {
  const link::Continuation& rest = outcome.result.rest;
  run.end = {end_name(outcome), rest.first, rest.from, {}};
  const bool is_complete = rest.first >= prepared.job.size();
  if (!is_complete) run.stopped_before = points_done(prepared.job, options.from, outcome.result);
  if (!is_complete && run.end.name != "done")
    run.end.continue_with = continue_command(options.command, rest, outcome.is_kept);
}

}  // namespace

report::JobRun begin_run(const PreparedJob& prepared, geometry::PointCloud points,
                         const std::string& board, std::size_t from) {
  const job::Job& job = prepared.job;
  report::JobRun run;
  run.input = prepared.input;
  run.mode = mode_name(job.header.mode);
  run.board = board;
  run.making = prepared.making;
  run.first_number = from;
  run.items = job.size();
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

report::JobRun run_on_board(const PreparedJob& prepared, const BoardOptions& options,
                            const JobOutcome& outcome) {
  const auto before = static_cast<std::ptrdiff_t>(prepared.job.points_before(options.from));
  report::JobRun run =
      begin_run(prepared, {prepared.points.begin() + before, prepared.points.end()}, options.board,
                options.from);
  add_counters(prepared, options, outcome.result, run);
  add_end(prepared, options, outcome, run);
  return run;
}

}  // namespace lamplock::run
