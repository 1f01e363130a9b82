// The report of a program or of rows as a page.
//
// In:  how it ended, its record in the history, its path. Out: one HTML document without scripts.
// Who: the history, in its background thread. Jobs of points have host/report/page.hpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/material/job_history.hpp"
#include "host/serve/shown_path.hpp"

namespace lamplock::run {
struct ProgramOutcome;
struct SentJob;
}  // namespace lamplock::run

namespace lamplock::serve {

/// Facts that the page shows in addition to the record.
struct RunReport {
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value
  /// The lines done of all lines are a share of the lines of the file: not with --from, nor with
  /// O-words, whose lines are repeated.
  bool has_share = true;
};

/// Facts of a program: times, place at its end.
RunReport report_of(const run::ProgramOutcome& outcome);
/// Facts of a job of rows: times, starvations, frames sent again.
RunReport report_of(const run::SentJob& rows);

/// `path` is seen from above; empty: no picture.
std::string run_page(const material::JobRecord& record, const RunReport& report,
                     const std::vector<PathPlace>& path);

}  // namespace lamplock::serve
