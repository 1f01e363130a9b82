// `lamplock estimate`: what a job will take, to the beat, without running it.
#include <fmt/chrono.h>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving_options.hpp"
#include "host/cli/origin.hpp"
#include "host/report/statistics.hpp"
#include "host/report/summary.hpp"
#include "host/run/estimate_job.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::cli {
namespace {

using Clock = std::chrono::system_clock;

struct EstimateOptions {
  EngravingOptions engraving;
  run::EstimateOptions estimate{};
  bool json = false;
};

/// A job file has been made: options that make a job are refused.
void take_request(EstimateOptions& options) {
  std::string& origin = options.estimate.request.origin;
  if (!run::is_job_file(options.engraving.input)) {
    run::JobRequest request = options.engraving.request();
    request.origin = origin;
    options.estimate.request = std::move(request);
    return;
  }
  const std::string why = "is used only to make a job, but INPUT is a finished job file",
                    remedy = "leave it out";
  options.engraving.refuse_options(why, remedy);
  if (origin != run::origin_machine) throw Error(Exit::bad_input, "--origin", why, remedy);
  options.estimate.request.input = options.engraving.input;
}

Exit estimate(EstimateOptions options) {
  Console console(options.json);
  take_request(options);
  const run::Estimated estimated = run::estimate_job(options.estimate, console);
  const auto ends = Clock::now() + std::chrono::round<Clock::duration>(
                                       std::chrono::duration<double>(estimated.seconds));
  console.line("");
  console.text(report::estimate_summary(estimated.report));
  console.say("  if the job starts now, it ends on {:%F at %H:%M:%S}",
              fmt::localtime(Clock::to_time_t(ends)));
  if (console.json()) {
    Json json = Json::parse(report::to_json(estimated.report));
    json["whole_time_s"] = estimated.seconds;
    json["ends"] = report::date_text(ends);
    console.document(json);
  }
  return Exit::done;
}

}  // namespace

void add_estimate(Command& program) {
  Command& app = program.add_command(
      "estimate", "Predict beats and duration of a job; --page shows them in a browser");
  app.footer(
      "The firmware's own planner plans the job. The run has the same beats and duration if no "
      "lamp\n"
      "flash is missing and the host sends all points in time.\n"
      "Example:\n"
      "  lamplock estimate model.stl --size 40 --spacing 0.3 --page model.html\n"
      "  lamplock estimate model.llj --from 5120 --job-speed 80");
  const auto options = std::make_shared<EstimateOptions>();
  options->engraving.add(app, true);
  for (Option& option : app.options())
    if (option.is_positional()) option.help(option.help() + "; or a job file (llj)");
  add_part(app, options->estimate.job);
  add_job_speed(app, options->estimate.job);
  add_origin(app, options->estimate.request.origin);
  app.add_option("--page", &options->estimate.page, "Write a page (HTML) that shows the job")
      .common()
      .value_name("FILE")
      .file(FileUse::write, ".html");
  app.add_json(options->json);
  app.action([options, &program] {
    options->estimate.job.command = program.typed();
    return estimate(*options);
  });
}

}  // namespace lamplock::cli
