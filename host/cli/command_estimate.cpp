// `lamplock estimate`: what a job will take, to the beat, without running it.
#include <fmt/chrono.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

#include "host/cli/board_files.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/mode_name.hpp"
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

struct Options {
  EngravingOptions engraving;
  std::size_t from = 0;
  std::uint32_t job_speed = link::full_job_speed;
  std::string page{};
  bool json = false;
};

/// A job as `send` would take it, or made as `engrave` would make it.
Work read_work(const Options& options, Console& console) {
  const std::string& input = options.engraving.input;
  if (lower_extension(input) != ".llj") return make_work(options.engraving, false, console);
  Work work{input, {}, job::read_job_file(input)};
  if (!work.job.is_rows()) work.points = points_of(work.job);
  return work;
}

/// The estimate in the form of a run, as far as one can be foreseen. Of ten million points there is
/// no room for two copies, nor for the job beside them.
report::JobRun run_of(Work work, const Options& options, estimate::Estimate told) {
  report::JobRun run;
  run.input = std::move(work.input);
  run.mode = mode_name(work.job.header.mode);
  run.board = "estimate";
  run.first_point = work.job.points_before(options.from);
  run.points = std::move(work.points);
  run.points.erase(run.points.begin(),
                   run.points.begin() + static_cast<std::ptrdiff_t>(run.first_point));
  for (std::size_t i = options.from; i < work.job.targets.size(); ++i)
    if (!work.job.is_pause(i)) run.shots_ordered.push_back(work.job.targets[i].shots);
  run.shots_known = false;
  run.shots_fired = told.shots;
  run.foreseen_beats = std::move(told.beat_of_shot);
  run.settings = work.job.settings;
  run.steps_per_mm = steps_per_mm(run.settings);
  run.refraction = work.job.refraction;
  run.warnings = std::move(work.warnings);
  run.beats = told.beats;
  run.beats_before = told.beats_before;
  run.time_s = told.time_s;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    run.beats_by_reason[std::string(beat_reason_names[i])] = told.beats_by_reason[i];
  return run;
}

estimate::Estimate estimate_work(const Work& work, const Options& options) {
  Progress progress("estimating", work.job.size(), options.from);
  estimate::EstimateOptions wanted;
  wanted.first = options.from;
  wanted.job_speed = options.job_speed;
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

Exit estimate(const Options& options) {
  Console console(options.json);
  if (!options.page.empty()) check_target(options.page);
  Work work = read_work(options, console);
  work.job.header.dry = false;
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

void add_estimate(CLI::App& program, Action& action) {
  CLI::App* app = program.add_subcommand(
      "estimate", "What a job will take, before it is engraved: beats, time, a page to look at");
  app->footer(
      "The job is planned by the firmware's own planner: beats and time are those of the run, if "
      "the\n"
      "lamp never fails and points never come late.\n"
      "Example:\n  lamplock estimate model.stl --size 40 --spacing 0.3 --page model.html\n"
      "  lamplock estimate model.llj --from 5120 --job-speed 80");
  const auto options = std::make_shared<Options>();
  options->engraving.add(*app, true);
  app->add_option("--from", options->from, "Begin at this point of the job")
      ->check(number_from(0, true))
      ->type_name("N");
  app->add_option("--job-speed", options->job_speed, "Speed of the job")
      ->check(CLI::Range(1u, link::highest_job_speed))
      ->type_name("PERCENT")
      ->capture_default_str();
  app->add_option("--page", options->page, "Page (HTML) that shows the job")
      ->check(file_name())
      ->type_name("FILE");
  app->add_flag("--json", options->json, "Print the result as JSON on stdout");
  app->callback([options, &action] { action = [options] { return estimate(*options); }; });
}

}  // namespace lamplock::cli
