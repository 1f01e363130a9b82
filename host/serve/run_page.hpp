// The report of a program or of rows as a page.
//
// In:  how it ended, its record in the history, its path. Out: one HTML document without scripts.
// Who: the history, in its background thread. Jobs of points have host/report/page.hpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/material/job_history.hpp"
#include "host/run/run_program.hpp"
#include "host/run/send_job.hpp"
#include "host/serve/shown_path.hpp"

namespace lamplock::serve {

/// What the page shows beside the record.
struct RunReport {
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value
  bool has_share = true;  ///< the lines done are a share of the lines of the path
};

RunReport report_of(const run::ProgramOutcome& outcome);
/// Of a job of rows.
RunReport report_of(const run::SentJob& rows);

/// `path` is seen from above; empty: no picture.
std::string run_page(const material::JobRecord& record, const RunReport& report,
                     const std::vector<PathPlace>& path);

}  // namespace lamplock::serve
