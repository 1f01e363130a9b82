#include "host/run/send_job.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/job/job.hpp"
#include "host/job/read_profile.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/raster/row_motion.hpp"
#include "host/run/job_board.hpp"
#include "host/run/kept_progress.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/permission.hpp"
#include "host/run/read_job.hpp"
#include "host/run/run_job.hpp"
#include "host/run/run_rows.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {

SentJob send_job(const std::string& file, BoardOptions& options, Frontend& frontend) {
  options.check({file});
  require_askable(options, frontend);
  auto port = open_job_port(options);
  SentJob sent{read_prepared_job(file), {}, 0};
  PreparedJob& prepared = sent.prepared;
  prepared.making.command = shell_text(options.command);
  job::Job& job = prepared.job;
  job.header.dry = job.header.dry || options.dry;
  if (options.is_simulated() && !options.profile.empty())
    prepared.machine = job::read_profile(options.profile).settings;
  const auto kept = keep_progress(prepared, options, port.get(), frontend);
  if (job.is_rows()) {
    sent.planned_s = raster::seconds_of(job, options.job_speed, options.from);
    sent.outcome =
        run_rows(prepared, options, sent.planned_s, std::move(port), frontend, kept.get());
    return sent;
  }
  subtract_fired(prepared, options);
  frontend.phase("job", fmt::format("{}: {} points, {}{}", file, prepared.points.size(),
                                    mode_name(job.header.mode), job.header.dry ? ", dry" : ""));
  sent.outcome = run_job(prepared, options, std::move(port), frontend, kept.get());
  return sent;
}

}  // namespace lamplock::run
