#include "host/run/job_run.hpp"

#include <algorithm>
#include <utility>

#include "host/link/job_result.hpp"
#include "host/run/board_files.hpp"
#include "host/run/continue_command.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/pause_beats.hpp"
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

/// The beats in which the machine cannot move yet.
bool is_before_motion(const std::string& reason) {
  return reason == name(BeatReason::not_locked) || reason == name(BeatReason::warm_up) ||
         reason == name(BeatReason::no_point_due);
}

/// The board counts the beats from the first shot to the last; in a dry run there is none. Its
/// beats are those from the time when the machine could move.
void count_motion(report::JobRun& run) {
  for (auto& [reason, outside] : run.beats_outside) {
    if (is_before_motion(reason)) continue;
    run.beats_by_reason[reason] += outside;
    run.beats += outside;
    run.beats_before -= std::min(run.beats_before, outside);
    outside = 0;
  }
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
  for (std::size_t i = 0; i < beat_reason_count; ++i) {
    const std::string reason(beat_reason_names[i]);
    run.beats_by_reason[reason] = status.beats_by_reason[i];
    run.beats_outside[reason] = status.beats_outside[i];
  }
  run.beats_by_reason[std::string(
      beat_reason_names[static_cast<std::size_t>(BeatReason::fired)])] += unreported;
  if (run.dry) count_motion(run);
  count_pauses(job, options.from, result.rest.first, run.beats_by_reason, run.beats_outside);
  run.time_s =
      static_cast<double>(run.beats) / in_units(run.settings, settings::Id::lamp_frequency);
  run.checks = {status.shots_made, status.shots_not_made, status.repeats};
  run.link = {result.resent, result.bad_frames + status.link.bad_frames, result.reconnects};
}

void add_end(const PreparedJob& prepared, const BoardOptions& options, const JobOutcome& outcome,
             report::JobRun& run) {
  const link::Continuation& rest = outcome.result.rest;
  const auto pauses_before = [&job = prepared.job](std::size_t item) {
    item = std::min(item, job.size());
    return item - job.points_before(item);
  };
  run.end = {end_name(outcome),       rest.first, rest.from, {}, pauses_before(rest.first),
             pauses_before(rest.from)};
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
  run.dry = job.header.dry;
  run.first_number = from;
  run.points = std::move(points);
  run.shots_ordered.reserve(run.points.size());
  run.flashes_per_point = 0;
  for (std::size_t i = from; i < job.targets.size(); ++i) {
    const wire::Target& target = job.targets[i];
    run.flashes_per_point = std::max<std::uint64_t>(run.flashes_per_point, target.shots);
    if (job.is_pause(i)) {
      run.pauses.push_back(static_cast<std::uint32_t>(run.shots_ordered.size()));
      run.pause_beats = std::max<std::uint64_t>(run.pause_beats, target.beats);
    } else {
      run.shots_ordered.push_back(job.header.dry ? 0 : target.shots);
    }
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
  run.points_before.assign(prepared.points.begin(), prepared.points.begin() + before);
  add_counters(prepared, options, outcome.result, run);
  add_end(prepared, options, outcome, run);
  return run;
}

}  // namespace lamplock::run
