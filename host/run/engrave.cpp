#include "host/run/engrave.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/glass/description_file.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/run/job_board.hpp"
#include "host/run/kept_progress.hpp"
#include "host/run/permission.hpp"
#include "host/run/run_job.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {

namespace {

/// The description of a job that was continued makes the whole job again: it says so at its begin.
void warn_in_description(report::Making& making, const BoardOptions& options) {
  if (making.description.empty() || (options.from == 0 && options.fired == 0)) return;
  const std::string fired = options.fired == 0 ? "" : fmt::format(" --fired {}", options.fired);
  making.description =
      fmt::format(
          "# This report is about the rest of a job: --from {}{}. Without these options\n"
          "# this description fires the whole job, also the points that were fired before.\n\n",
          options.from, fired) +
      making.description;
}

}  // namespace

JobOutcome engrave(const JobRequest& request, BoardOptions& options, Frontend& frontend) {
  options.profile = request.description.machine.profile;
  options.check(input_files(request), request.save);
  require_askable(options, frontend);
  auto port = open_job_port(options);
  PreparedJob prepared =
      prepare_job(request, options.dry, ask_origin(request.origin, port.get()), frontend);
  prepared.making.command = shell_text(options.command);
  if (!options.report.empty())
    prepared.making.description = glass::to_text(request.description, options.report);
  const auto kept = keep_progress(prepared, options, port.get(), frontend);
  warn_in_description(prepared.making, options);
  subtract_fired(prepared, options);
  return run_job(prepared, options, std::move(port), frontend, kept.get());
}

}  // namespace lamplock::run
