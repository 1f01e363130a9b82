#include "host/cli/finish_job.hpp"

#include "host/cli/documents.hpp"
#include "host/run/report_job.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::cli {

Exit finish_job(const run::JobOutcome& outcome, const run::BoardOptions& options,
                Console& console) {
  const report::Report report = run::report_job(outcome, options, console);
  if (console.json()) console.document(job_json(report, outcome));
  return run::judge_points(outcome, report, options, console);
}

}  // namespace lamplock::cli
