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
#include "host/run/unsaved_option.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {

namespace {

void check_saved_options(const JobRequest& request, const BoardOptions& options) {
  refuse_unsaved(request.save, options.dry, "--dry");
  refuse_unsaved(request.save, request.origin != origin_machine, "--origin");
  refuse_unsaved(request.save, options.from != 0, "--from");
  refuse_unsaved(request.save, options.fired != 0, "--fired");
  refuse_unsaved(request.save, options.resume, "--resume");
}

/// The description in a report makes the whole job, with light, at the origin of the machine: where
/// this run was another one, it says so at its begin.
void warn_in_description(report::Making& making, const JobRequest& request,
                         const BoardOptions& options) {
  if (making.description.empty()) return;
  if (options.dry)
    making.description =
        "# This report is about a dry run: without --dry this description fires.\n\n" +
        making.description;
  if (request.origin != origin_machine)
    making.description = fmt::format(
                             "# This report is about a run with --origin {}: without it the job is "
                             "in another place.\n\n",
                             request.origin) +
                         making.description;
  if (options.from == 0 && options.fired == 0) return;
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
  check_saved_options(request, options);
  require_askable(options, frontend);
  auto port = open_job_port(options);
  PreparedJob prepared =
      prepare_job(request, options.dry, ask_origin(request.origin, port.get()), frontend);
  prepared.making.command = shell_text(options.command);
  if (!options.report.empty())
    prepared.making.description = glass::to_text(request.description, options.report);
  const auto kept = keep_progress(prepared, options, port.get(), frontend);
  warn_in_description(prepared.making, request, options);
  subtract_fired(prepared, options);
  return run_job(prepared, options, std::move(port), frontend, kept.get());
}

}  // namespace lamplock::run
