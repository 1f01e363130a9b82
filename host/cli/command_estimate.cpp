// `lamplock estimate`: what a job will take, to the beat, without running it.
#include <fmt/chrono.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/job_run.hpp"
#include "host/cli/origin.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/staged_file.hpp"
#include "host/cli/validators.hpp"
#include "host/estimate/estimate.hpp"
#include "host/file.hpp"
#include "host/job/job_file.hpp"
#include "host/link/sender.hpp"
#include "host/report/page.hpp"
#include "host/report/statistics.hpp"
#include "host/report/summary.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::cli {
namespace {

using Clock = std::chrono::system_clock;

struct EstimateOptions {
  EngravingOptions engraving;
  BoardOptions job{};  ///< of these: which part of the job, and its speed
  OriginOption origin{};
  std::string page{};
  bool json = false;
};

/// A job as `send` would take it, or made as `engrave` would make it.
Work read_work(const EstimateOptions& options, Console& console) {
  const std::string& input = options.engraving.input;
  if (lower_extension(input) != ".llj")
    return make_work(options.engraving, false, console, options.origin.ask(nullptr));
  const std::string why = "is for making a job, this one is made", remedy = "leave it out";
  options.engraving.refuse_options(why, remedy);
  if (options.origin.name != "machine") throw Error(Exit::bad_input, "--origin", why, remedy);
  Work work{input, {}, job::read_job_file(input)};
  if (!work.job.is_rows()) work.points = points_of(work.job);
  return work;
}

/// The estimate in the form of a run, as far as one can be foreseen. Of ten million points there is
/// no room for two copies.
report::JobRun run_of(Work work, const EstimateOptions& options, estimate::Estimate told) {
  const auto before = static_cast<std::ptrdiff_t>(work.job.points_before(options.job.from));
  work.points.erase(work.points.begin(), work.points.begin() + before);
  report::JobRun run = begin_run(work, std::move(work.points), "estimate", options.job.from);
  run.shots_fired = told.shots;
  run.points_fired = run.points.size();
  run.foreseen_beats = std::move(told.beat_of_shot);
  run.beats = told.beats;
  run.beats_before = told.beats_before;
  run.time_s = told.time_s;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    run.beats_by_reason[std::string(beat_reason_names[i])] = told.beats_by_reason[i];
  return run;
}

estimate::Estimate estimate_work(const Work& work, const EstimateOptions& options) {
  Progress progress("estimating", work.job.size(), options.job.from);
  estimate::EstimateOptions wanted;
  wanted.first = options.job.from;
  wanted.fired = options.job.fired;
  wanted.job_speed = options.job.job_speed;
  wanted.progress = [&progress](std::size_t done) { progress.update(done); };
  return estimate::estimate_job(work.job, wanted);
}

void write_page_file(const report::Report& report, const report::JobRun& run,
                     const std::string& file, Console& console) {
  if (file.empty()) return;
  write_whole(file,
              [&](const std::filesystem::path& path) { report::write_page(report, run, path); });
  console.phase("page", file);
}

Exit estimate(const EstimateOptions& options) {
  Console console(options.json);
  check_distinct({{"--page", options.page}}, options.engraving.input);
  if (!options.page.empty()) check_target(options.page);
  Work work = read_work(options, console);
  work.job.header.dry = false;
  take_off_fired(work, options.job);
  estimate::Estimate told = estimate_work(work, options);
  const double seconds = told.time_before_s + told.time_s;
  const auto ends =
      Clock::now() + std::chrono::round<Clock::duration>(std::chrono::duration<double>(seconds));
  const report::JobRun run = run_of(std::move(work), options, std::move(told));
  const report::Report report = report::evaluate(run);
  console.phase("estimate", fmt::format("{} points", report.points));
  write_page_file(report, run, options.page, console);
  console.line("");
  console.text(report::estimate_summary(report));
  console.say("  begun now it ends on {:%F at %H:%M:%S}", fmt::localtime(Clock::to_time_t(ends)));
  if (console.json()) {
    Json json = Json::parse(report::to_json(report));
    json["whole_time_s"] = seconds;
    json["ends"] = report::date_text(ends);
    console.document(json);
  }
  return Exit::done;
}

}  // namespace

void add_estimate(Command& program) {
  Command& app = program.add_command(
      "estimate", "What a job will take, before it is engraved: beats, time, a page to look at");
  app.footer(
      "The job is planned by the firmware's own planner: beats and time are those of the run, if "
      "the\n"
      "lamp never fails and points never come late.\n"
      "Example:\n  lamplock estimate model.stl --size 40 --spacing 0.3 --page model.html\n"
      "  lamplock estimate model.llj --from 5120 --job-speed 80");
  const auto options = std::make_shared<EstimateOptions>();
  options->engraving.add(app, true);
  options->job.add_part(app);
  options->job.add_job_speed(app);
  options->origin.add(app);
  app.add_option("--page", &options->page, "Page (HTML) that shows the job")
      .check(file_name())
      .value_name("FILE");
  app.add_json(options->json);
  app.action([options] { return estimate(*options); });
}

}  // namespace lamplock::cli
