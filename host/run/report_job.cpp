#include "host/run/report_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>

#include "host/link/board_text.hpp"
#include "host/link/not_ready.hpp"
#include "host/report/statistics.hpp"
#include "host/report/summary.hpp"
#include "host/run/report_folder.hpp"
#include "host/run/supervisor.hpp"

namespace lamplock::run {
namespace {

using link::JobEnd;

/// An error after the first shot is a failed job, whatever it is an error of.
Exit judge_failure(const std::exception_ptr& error, Frontend& frontend) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& failure) {
    const bool says_nothing_was_done =
        failure.exit() == Exit::bad_input || failure.exit() == Exit::no_device;
    if (!says_nothing_was_done) throw;
    frontend.notice(failure.what());
  }
  return Exit::job_failed;
}

/// The headline of a job that the user has stopped is the last line, after the table.
bool says_end_last(const JobOutcome& outcome) {
  return outcome.result.end == JobEnd::stopped && outcome.ended_by.empty() && !outcome.error &&
         !outcome.report.end.continue_with.empty();
}

/// The rest of a job in numbers for readers: pauses are not counted with the points.
link::Continuation shown_rest(const JobOutcome& outcome) {
  link::Continuation rest = outcome.result.rest;
  rest.first -= std::min(rest.first, static_cast<std::size_t>(outcome.run.end.pauses_before));
  rest.from -= std::min(rest.from, static_cast<std::size_t>(outcome.run.end.pauses_before_end));
  return rest;
}

/// The argument of --from counts pauses too.
std::string continuation_text(const JobOutcome& outcome, const char* item) {
  const link::Continuation& rest = outcome.result.rest;
  const std::string doubt = link::doubt_text(shown_rest(outcome), item);
  if (doubt.empty() || (!rest.settled && outcome.is_kept))
    return link::continuation_text(rest, item, outcome.is_kept);
  return fmt::format("continue with {} ({})", link::continuation_options(rest), doubt);
}

/// If the machine was not at rest at its last report, the number in it is a lower bound.
std::string bound_text(const link::Continuation& rest, const char* item) {
  if (!rest.settled) return fmt::format("at least the {}s before {} are done", item, rest.first);
  return fmt::format("first {} not done is {}", item, rest.first);
}

/// The end of a job before its last item.
const char* early_end_text(const JobOutcome& outcome) {
  if (outcome.error) return "the job failed";
  switch (outcome.result.end) {
    case JobEnd::done:
    case JobEnd::stopped:
      return "the job was stopped";
    case JobEnd::alarm:
      return "an alarm ended the job";
    case JobEnd::lost:
      return "the connection was lost";
    case JobEnd::replaced:
      return "another job replaced the job";
    case JobEnd::restarted:
      return "the machine restarted";
  }
  return "the job ended";
}

/// What was done although a file is lost: the whole job, or how far it came.
std::string done_text(const JobOutcome& outcome, const char* item) {
  const link::JobResult& result = outcome.result;
  if (result.end == JobEnd::done && !outcome.error)
    return result.status.shots != 0 ? "the job was fired" : "the job was run";
  const link::Continuation rest = shown_rest(outcome);
  return rest.settled ? fmt::format("{} before {} {}", early_end_text(outcome), item, rest.first)
                      : fmt::format("{}, {}", early_end_text(outcome), bound_text(rest, item));
}

/// What ends an alarm; a simulated board has forgotten it.
std::string way_out_of_alarm(const JobOutcome& outcome, const BoardOptions& options) {
  const wire::Status& status = outcome.result.status;
  if (options.is_simulated()) return "find its cause";
  return fmt::format("{}, then {}",
                     status.state == wire::MachineState::estop ? "release it" : "find its cause",
                     link::way_to_unlock(options.board, outcome.homing));
}

/// The exit status without regard to files.
Exit judge_machine(const JobOutcome& outcome, const BoardOptions& options, const char* item,
                   Frontend& frontend) {
  if (outcome.error) return judge_failure(outcome.error, frontend);
  const link::JobResult& result = outcome.result;
  const std::size_t next = shown_rest(outcome).first;
  // A command without its words has no --from: test flashes, the frame.
  const std::string how_to_continue =
      options.command.empty() ? "repeat the command if needed" : continuation_text(outcome, item);
  std::string what, remedy;
  switch (result.end) {
    case JobEnd::done:
      return Exit::done;
    case JobEnd::stopped:
      if (!outcome.ended_by.empty())
        throw_stopped(outcome.ended_by, fmt::format("stopped before {} {}", item, next),
                      "release it, close it, and " + how_to_continue);
      frontend.notice(says_end_last(outcome) ? report::headline(outcome.report)
                                             : fmt::format("stopped: first {} not fired is {}; {}",
                                                           item, next, how_to_continue));
      return Exit::interrupted;
    case JobEnd::alarm:
      what = fmt::format("{} before {} {}",
                         result.status.state == wire::MachineState::estop
                             ? "e-stop"
                             : link::alarm_text(result.status.alarm),
                         item, next);
      remedy = way_out_of_alarm(outcome, options) + ", then ";
      break;
    case JobEnd::lost:
      what = "connection lost, so that the machine could not be stopped; " +
             bound_text(shown_rest(outcome), item);
      remedy = "check that it is at rest, check the cable and ";
      break;
    case JobEnd::replaced:
      what = "another program has begun a job on the machine; " +
             bound_text(shown_rest(outcome), item);
      remedy = "end that and ";
      break;
    case JobEnd::restarted:
      what = "the machine has restarted, its position is lost; " +
             bound_text(shown_rest(outcome), item);
      remedy = "home it and ";
      break;
  }
  throw Error(Exit::job_failed, options.board, what, remedy + how_to_continue);
}

}  // namespace

void write_numbers(JobOutcome& outcome, const BoardOptions& options) {
  outcome.report = report::evaluate(outcome.run);
  if (outcome.folder) outcome.folder->write_numbers(outcome.report, outcome.lost);
  if (options.statistics.empty()) return;
  outcome.lost.attempt(options.statistics, [&] {
    report::append_statistics(options.statistics, outcome.report, end_name(outcome),
                              std::chrono::system_clock::now());
  });
}

void report_job(JobOutcome& outcome, const BoardOptions& options, Frontend& frontend) {
  frontend.line("");
  frontend.text(says_end_last(outcome) ? report::table(outcome.report)
                                       : report::summary(outcome.report));
  if (!outcome.folder) return;
  frontend.restart_clock();
  outcome.folder->write_rest(outcome.report, outcome.run, outcome.lost);
  for (const std::string& lost : outcome.lost.names())
    for (const std::filesystem::path& file : files_of_report(options.report))
      if (file == lost) return;  // the error names it
  frontend.line("");
  frontend.phase("report", options.report);
}

Exit judge_points(const JobOutcome& outcome, const BoardOptions& options, Frontend& frontend) {
  const Exit exit = judge_end(outcome, options, "point", frontend);
  if (exit == Exit::interrupted) return exit;
  const auto missed = outcome.report.missed.value_or(0),
             doubled = outcome.report.doubled.value_or(0);
  if (missed == 0 && doubled == 0) return exit;
  throw Error(Exit::job_failed, "job",
              fmt::format("{} points not fired, {} shots too many", missed, doubled),
              "do not continue with this glass; please report it with its input");
}

Exit judge_end(const JobOutcome& outcome, const BoardOptions& options, const char* item,
               Frontend& frontend) {
  const Exit exit = outcome.lost.report(Exit::done, done_text(outcome, item), frontend);
  const Exit of_machine = judge_machine(outcome, options, item, frontend);
  return of_machine == Exit::done ? exit : of_machine;
}

}  // namespace lamplock::run
