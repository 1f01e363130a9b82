#include "host/cli/report_job.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>

#include "host/cli/console.hpp"
#include "host/cli/guarding.hpp"
#include "host/cli/report_folder.hpp"
#include "host/report/statistics.hpp"
#include "host/report/summary.hpp"

namespace lamplock::cli {
namespace {

using link::JobEnd;

/// What the machine has refused in mid-job is no longer bad input alone: the glass is begun.
Exit tell_failure(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& told) {
    if (told.exit() != Exit::bad_input) throw;
    fmt::print(stderr, "{}\n", told.what());
  }
  return Exit::job_failed;
}

std::string go_on_text(const Outcome& outcome, const char* item) {
  return link::go_on_text(outcome.result.rest, item, outcome.is_kept);
}

/// If the machine was not at rest at its last report, the number in it is a lower bound.
std::string bound_text(const link::Continuation& rest, const char* item) {
  if (!rest.settled) return fmt::format("at least the {}s before {} are done", item, rest.first);
  return fmt::format("first {} not done is {}", item, rest.first);
}

}  // namespace

Exit report_job(const Outcome& outcome, const BoardOptions& options, Console& console) {
  const report::Report report = report::evaluate(outcome.run);
  if (end_name(outcome) != "done")  // known even if the report cannot be written
    console.say("{}; {}", bound_text(outcome.result.rest, "point"), go_on_text(outcome, "point"));
  console.line("");
  console.text(report::summary(report));
  if (!options.report.empty()) {
    console.restart_clock();
    write_report_whole(report, outcome.run, options.report);
    console.line("");
    console.phase("report", options.report);
  }
  if (console.json()) {
    Json json = Json::parse(report::to_json(report));
    json["end"] = end_name(outcome);
    json["first_unfired"] = outcome.result.status.first_unfired;
    json["flashes_fired"] = outcome.result.flashes_fired;
    json["may_have_fired"] = outcome.result.rest.from;
    json["warnings"] = outcome.run.warnings;
    console.document(json);
  }
  if (!options.statistics.empty())
    report::append_statistics(options.statistics, report, end_name(outcome),
                              std::chrono::system_clock::now());
  const Exit exit = tell_end(outcome, options, "point");
  if (exit != Exit::done) return exit;
  const auto missed = report.missed.value_or(0), doubled = report.doubled.value_or(0);
  if (missed == 0 && doubled == 0) return Exit::done;
  throw Error(Exit::job_failed, "job",
              fmt::format("{} points not fired, {} shots too many", missed, doubled),
              "do not go on with this glass; please report it with its input");
}

Exit tell_end(const Outcome& outcome, const BoardOptions& options, const char* item) {
  if (outcome.error) return tell_failure(outcome.error);
  const link::JobResult& result = outcome.result;
  const std::size_t next = result.rest.first;
  const std::string go_on = go_on_text(outcome, item);
  std::string what, remedy;
  switch (result.end) {
    case JobEnd::done:
      return Exit::done;
    case JobEnd::stopped:
      if (!outcome.ended_by.empty())
        throw_guarded(outcome.ended_by, fmt::format("stopped before {} {}", item, next),
                      "release it, close it, and " + go_on);
      fmt::print(stderr, "stopped: first {} not fired is {}; {}\n", item, next, go_on);
      return Exit::interrupted;
    case JobEnd::alarm:
      what = fmt::format("{} before {} {}",
                         result.status.state == wire::MachineState::estop
                             ? "e-stop"
                             : fmt::format("alarm {}", static_cast<int>(result.status.alarm)),
                         item, next);
      remedy = "clear it and ";
      break;
    case JobEnd::lost:
      what = "connection lost, so that the machine could not be stopped; " +
             bound_text(result.rest, item);
      remedy = "see that it stands, check the cable and ";
      break;
    case JobEnd::replaced:
      what = "another program has begun a job on the machine; " + bound_text(result.rest, item);
      remedy = "end that and ";
      break;
    case JobEnd::restarted:
      what = "the machine has restarted, its position is lost; " + bound_text(result.rest, item);
      remedy = "home it and ";
      break;
  }
  throw Error(Exit::job_failed, options.board, what, remedy + go_on);
}

}  // namespace lamplock::cli
