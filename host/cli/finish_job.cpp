#include "host/cli/finish_job.hpp"

#include "host/cli/documents.hpp"
#include "host/run/report_job.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::cli {

Exit finish_job(run::JobOutcome& outcome, const run::BoardOptions& options, Console& console) {
  run::report_job(outcome, options, console);
  if (console.json()) console.document(job_json(outcome));
  return run::judge_points(outcome, options, console);
}

}  // namespace lamplock::cli
