// Runs a job of rows of pixels, as `lamplock raster` makes them.
//
// In:  a job, where to run it. Out: the outcome and the planned time.
// Who: send_job().
#pragma once

#include <memory>
#include <string>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::link {
class KeptJob;
class Transport;
}  // namespace lamplock::link

namespace lamplock::run {

/// "12 lines, 3000 pixels in 3 rows": the contents of a job of rows; dark cells are no pixels.
std::string rows_text(const job::Job& job);

/// Runs it to its end. With --from it begins one line earlier, dark, so that the row continues in
/// motion. `planned_s`: its planned time. Throws Error for options that are for points alone, and
/// as run_job().
JobOutcome run_rows(PreparedJob& prepared, BoardOptions options, double planned_s,
                    std::unique_ptr<link::Transport> port, Frontend& frontend,
                    link::KeptJob* kept = nullptr);

}  // namespace lamplock::run
