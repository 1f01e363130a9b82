// Sends a job of rows of pixels and tells how it went: `send` with what `lamplock raster` has made.
//
// In:  a job, where to run it. Out: the run, told on the console; the exit status.
#pragma once

#include <memory>

#include "host/cli/options.hpp"
#include "host/cli/work.hpp"
#include "host/error.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"

namespace lamplock::cli {

class Console;

/// "12 lines, 3000 pixels in 3 rows": what a job of rows consists of; dark cells are no pixels.
std::string rows_text(const job::Job& job);

/// Runs it to its end. With --from it begins at the line before, dark, so that the row is gone on
/// with in motion. Throws Error for options that are for points alone, and as run_job().
Exit send_rows(Work& work, BoardOptions options, std::unique_ptr<link::Transport> port,
               Console& console, link::KeptJob* kept = nullptr);

}  // namespace lamplock::cli
