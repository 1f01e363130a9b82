#include "host/link/kept_job.hpp"

#include <algorithm>
#include <vector>

#include "host/error.hpp"
#include "host/link/job_inquiry.hpp"
#include "host/units.hpp"
#include "shared/look_ahead.hpp"

namespace lamplock::link {

using job::Progress;

namespace {

/// A board holds when its host is silent for the dead-man time (2 s). It cannot fire more points
/// than that without the host, and after a power loss all points sent are in doubt.
constexpr double ahead_s = 2.5;
/// Points with which the planner never starves: the window in motion, the one after it, the one
/// being planned, a frame under way, and the look-ahead along rows of points.
constexpr std::size_t min_points_ahead = 4 * window_points + run_horizon;

}  // namespace

KeptJob::KeptJob(const std::filesystem::path& journal, const job::Job& job)
    : journal_(journal), job_(job), hash_(job::hash_of(job)) {}

void KeptJob::require_ended() const {
  const auto run = journal_.read().run;
  if (!run || run->last.progress == Progress::ended) return;
  if (run->last.job != hash_)
    throw Error(Exit::bad_input, file().string(),
                "a run of this input with other options has no known end, started from its "
                "beginning it fires points twice",
                "continue it by --resume and its own options, or discard it with --discard");
  throw Error(
      Exit::bad_input, file().string(),
      "the last run of this job has no known end, started from its beginning it fires points twice",
      "continue it by --resume, or discard it with --discard");
}

std::optional<std::size_t> KeptJob::stopped_at() const {
  const auto run = journal_.read().run;
  if (!run || run->last.job != hash_ || run->last.progress != Progress::ended) return std::nullopt;
  return run->last.first_unfired;
}

job::JournalContents KeptJob::read() const {
  const job::JournalContents contents = journal_.read();
  if (contents.empty())
    throw Error(Exit::bad_input, file().string(), "contains no run to continue",
                "if the job has fired points, find the first one that was not fired (last message, "
                "or the glass) and continue with --from N; if it was never begun, leave out "
                "--resume");
  const bool is_ours = contents.run && contents.run->last.job == hash_;
  const bool offers_ours =
      std::ranges::count(contents.offered, hash_, &job::ProgressRecord::job) > 0;
  if (!is_ours && !offers_ours)
    throw Error(Exit::bad_input, file().string(), "contains the run of another job",
                "give the options of that run, or discard it with --discard");
  return contents;
}

Continuation KeptJob::find(Transport& port) {
  journal_.lock();
  const job::JournalContents contents = read();
  const auto& [run, offered] = contents;
  std::vector<std::uint32_t> sessions;
  for (const job::ProgressRecord& one : offered) sessions.push_back(one.session);
  if (run) sessions.push_back(run->last.session);
  JobInquiry inquiry(port);
  const wire::Status status = inquiry.end_job(sessions);
  // A run that was offered counts if the board reports its session, or if no run was accepted.
  const job::ProgressRecord* taken = contents.find_offered(status.session);
  if (taken == nullptr && !run)
    taken = &*std::ranges::find(offered, hash_, &job::ProgressRecord::job);
  const job::KeptRun last = taken != nullptr ? job::KeptRun{*taken, *taken} : *run;
  if (last.last.job != hash_)
    throw Error(Exit::bad_input, file().string(), "the board has begun another job after this one",
                "find the first point that was not fired (last message, or the glass) and continue "
                "with --from N, or discard this run with --discard");
  const Continuation rest = rest_of(last, status, inquiry.restart_mark());
  // The board loses this status as soon as it accepts another job, so it is recorded, as running:
  // until the rest of the job is begun, the job must not start from its beginning.
  session_ = last.last.session;
  append(Progress::running, rest);
  session_ = 0;
  return rest;
}

/// The rest is settled: no other source can be asked.
Continuation KeptJob::rest_of(const job::KeptRun& run, const wire::Status& status,
                              const std::optional<RestartMark>& mark) const {
  if (status.session == run.last.session) return reported_by_board(run, status);
  if (mark && mark->session == run.last.session) return after_restart(job_, *mark);
  return {run.last.first_unfired, run.last.flashes, run.last.may_have_fired, true};
}

Continuation KeptJob::reported_by_board(const job::KeptRun& run, const wire::Status& status) const {
  const std::size_t from = run.begun.first_unfired;
  const std::size_t next = std::max<std::size_t>(status.first_unfired, from);
  const std::uint64_t shots = std::uint64_t{status.shots} + run.begun.flashes;
  const std::uint32_t flashes = flashes_of(job_.targets, from, next, shots);
  if (next >= run.last.may_have_fired) return {next, flashes, next, true};
  return at_rest(job_, next, flashes);
}

void KeptJob::keep(SenderOptions& options) {
  options.on_progress = [this](const JobProgress& progress) { note(progress); };
  if (job_.is_rows()) return;
  const double lamp_hz = in_units(job_.settings, settings::Id::lamp_frequency);
  options.points_ahead = std::max(min_points_ahead, static_cast<std::size_t>(ahead_s * lamp_hz));
}

void KeptJob::note(const JobProgress& progress) {
  if (session_ != 0)
    return append(Progress::running, {progress.first_unfired, 0, progress.may_have_fired, false});
  session_ = progress.session;
  append(Progress::begun, {from_, fired_, from_, true});
}

void KeptJob::finish(const JobResult& result) {
  const bool is_taken = session_ != 0 && result.status.session == session_;
  if (!is_taken) return;
  if (result.end == JobEnd::done) return journal_.remove();
  append(result.rest.settled ? Progress::ended : Progress::running, result.rest);
}

void KeptJob::append(Progress progress, const Continuation& rest) {
  journal_.append({progress, session_, hash_, static_cast<std::uint32_t>(rest.first), rest.flashes,
                   static_cast<std::uint32_t>(rest.from)});
}

}  // namespace lamplock::link
