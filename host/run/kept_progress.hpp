// The journal of a job that a command runs: whether it may begin, and where.
//
// In:  a job as it was made, the board to ask, --resume, --discard, --from. Out: the journal for
//      run_job(); --from and --fired of a resumed job; the points in doubt, on the console and
//      in a file.
// Who: `engrave` and `send`, before they run a job.
#pragma once

#include <memory>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::link {
class KeptJob;
class Transport;
}  // namespace lamplock::link

namespace lamplock::run {

/// Nothing for a job that keeps no progress: on a simulated board (no `port`), or a dry one. Throws
/// Error: job_failed (the last run has no known end; nothing is left to fire), and as
/// KeptJob::find().
std::unique_ptr<link::KeptJob> keep_progress(const PreparedJob& prepared, BoardOptions& options,
                                             link::Transport* port, Frontend& frontend);

}  // namespace lamplock::run
