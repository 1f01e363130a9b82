// The beats and the time of a job, without running it.
//
// In:  a request or a job file, which part of it. Out: the estimate as a report.
// Who: `estimate`.
#pragma once

#include <string>

#include "host/report/report.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/prepare_job.hpp"

namespace lamplock::run {

struct EstimateOptions {
  JobRequest request{};  ///< without a description if its input is a job (sent_file.hpp)
  BoardOptions job{};    ///< of these: which part of the job, and its speed
  std::string page{};    ///< HTML file; empty: none
};

struct Estimated {
  report::Report report;
  double seconds = 0;  ///< from the start to the last shot, lock and approach included
};

/// Throws Error.
Estimated estimate_job(const EstimateOptions& options, Frontend& frontend);

}  // namespace lamplock::run
