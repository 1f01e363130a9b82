// The machine in a job: a use case of host/run borrows the connection.
#include <chrono>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/report/page.hpp"
#include "host/run/report_job.hpp"
#include "host/run/run_program.hpp"
#include "host/run/send_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/clouds.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/lent_transport.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/material_choice.hpp"
#include "host/serve/read_path.hpp"
#include "host/serve/run_page.hpp"
#include "shared/beat_reason.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::serve {
namespace {

std::int64_t wasted_beats(const wire::Status& status) {
  std::int64_t all = 0;
  for (const std::uint32_t beats : status.beats_by_reason) all += beats;
  return all - status.beats_by_reason[static_cast<std::size_t>(BeatReason::fired)];
}

/// Reads the path again, which takes as long as a check. The report has no path if the file is not
/// the one that has run, `file`.
auto report_page(const JobStart& job, const run::MachineOptions& machine, RunReport report,
                 const std::string& file) {
  return [job, machine, report = std::move(report), file](const material::JobRecord& record) {
    std::vector<PathPlace> path;
    try {
      if (state_of(job.path) == file) path = read_path(job.path, machine, job.material).places();
    } catch (const std::exception&) {
      path.clear();  // the rest of the report does not need it
    }
    return run_page(record, report, path);
  };
}

}  // namespace

run::BoardOptions Machine::options_for(const JobStart& job) const {
  run::BoardOptions options = options_;
  options.opener = [this] { return std::make_unique<LentTransport>(*transport_); };
  options.yes = true;  // the server has the permission
  options.dry = job.is_dry;
  options.resume = job.resumes;
  options.from = job.from;
  return options;
}

void Machine::run_job(const JobStart& job) {
  supervisor_.reset();
  const std::shared_ptr<JobRequests> requests = requests_;
  PageFrontend frontend(*requests,
                        {[this](const std::string& text) { show(text); },
                         [this](const std::function<void(BoardView&, JobView&)>& change) {
                           const std::lock_guard lock(mutex_);
                           change(view_.board, view_.job);
                         }});
  {
    const std::lock_guard lock(mutex_);
    view_.board.state = "Run";
  }
  // Clients know the file by its name, and not the folders of the server.
  const auto message = [&job] {
    std::string text = message_of(std::current_exception());
    for (std::size_t at; (at = text.find(job.path)) != std::string::npos;)
      text.replace(at, job.path.size(), job.name);
    return text;
  };
  std::string end;
  EndedJob ended;
  ended.begin = std::chrono::system_clock::now();
  try {
    if (run::kind_of_sent_file(job.path) == run::SentKind::program)
      run_program(job, frontend, ended, end);
    else
      run_file(job, frontend, ended, end);
    end_job(end, "", std::move(ended));
  } catch (...) {
    end_job(end.empty() || end == "done" ? "failed" : end, message(), std::move(ended));
  }
}

/// Sets `end` when the program has ended; judge_program() may throw after that.
void Machine::run_program(const JobStart& job, PageFrontend& frontend, EndedJob& ended,
                          std::string& end) {
  const run::BoardOptions options = options_for(job);
  const std::string file = state_of(job.path);
  const run::ProgramOptions program_options{false, machine_, run::process_values(job.material)};
  if (program_options.process) show("material: " + run::text_of(*program_options.process));
  const run::ProgramOutcome outcome =
      run::run_program(job.path, options, program_options, frontend);
  end = end_name(outcome);
  RunReport report = report_of(outcome);
  report.has_share = job.from == 0 && !outcome.has_flow;
  ended.report = report_page(job, machine_, std::move(report), file);
  run::judge_program(outcome, options.board, frontend);
}

/// Runs a job of points or rows; sets `end` as run_program() does.
void Machine::run_file(const JobStart& job, PageFrontend& frontend, EndedJob& ended,
                       std::string& end) {
  refuse_for_jobs(job.material);
  const std::string file = state_of(job.path);
  run::BoardOptions options = options_for(job);
  const auto sent = std::make_shared<run::SentJob>(run::send_job(job.path, options, frontend));
  sent->outcome.report.input = sent->outcome.run.input = job.name;  // no path of the server
  end = end_name(sent->outcome);
  ended.item = sent->prepared.job.item();
  if (sent->prepared.job.is_rows()) {
    ended.report = report_page(job, machine_, report_of(*sent), file);
    run::judge_end(sent->outcome, options, sent->prepared.job.item(), frontend);
    return;
  }
  ended.wasted_beats = wasted_beats(sent->outcome.result.status);
  ended.report = [sent](const material::JobRecord&) {
    return report::page(sent->outcome.report, sent->outcome.run);
  };
  run::judge_points(sent->outcome, options, frontend);
}

void Machine::end_job(const std::string& end, const std::string& message, EndedJob ended) {
  show(message.empty() ? "job: " + end : "job: " + end + ": " + message);
  const std::lock_guard lock(mutex_);
  requests_.reset();
  stop_ = false;
  view_.job.is_running = false;
  view_.job.end = end;
  view_.job.message = message;
  if (end == "done") view_.job.done = view_.job.total;  // the last progress is not shown
  view_.job.word.clear();
  view_.job.left_s.reset();
  ended.view = view_.job;
  ended.end = std::chrono::system_clock::now();
  ended_.push_back(std::move(ended));
}

}  // namespace lamplock::serve
