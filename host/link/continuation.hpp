// Where a job that ended early continues, and which of its points may or may not have been fired.
//
// In:  the last report of the board, the items sent to it, the mark of a restart.
// Out: the options with which no point is fired more often than ordered.
// Who: JobSender for its errors, KeptJob, the command line.
//
//   0 ........ first ............. from .............. size
//     all fired        in doubt         none fired
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "host/job/job.hpp"
#include "host/link/restart_mark.hpp"
#include "shared/wire/status.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::link {

/// The rest of a job. Items are points, or lines of a job of rows.
struct Continuation {
  std::size_t first = 0;      ///< all items before it are done, as often as ordered
  std::uint32_t flashes = 0;  ///< of that point that were fired; 0 if it is in doubt
  std::size_t from = 0;       ///< no item from here on was done; first <= from
  /// The board was at rest when it reported, or has marked its restart. Otherwise `first` is a
  /// lower bound, and the board may have a later number.
  bool settled = false;

  bool in_doubt() const { return from > first; }
};

/// The board is at rest: no job is unfinished, or an alarm has ended it. From these states only
/// another job or the user at the machine can start motion.
bool is_at_rest(wire::MachineState state);

/// The board is at rest and has reported the first item not done. A line of pixels in which the
/// machine has stopped is engraved in part.
Continuation at_rest(const job::Job& job, std::size_t first, std::uint32_t flashes);

/// The board has restarted by itself. The number of flashes fired at the point is unknown.
Continuation after_restart(const job::Job& job, const RestartMark& mark);

/// Flashes of point `next` among `shots` that begin at point `from` of the targets.
std::uint32_t flashes_of(std::span<const wire::Target> targets, std::size_t from, std::size_t next,
                         std::uint64_t shots);

/// "--from 12 --fired 3"
std::string continuation_options(const Continuation& rest);

/// "points 503 to 686 may have been fired"; empty if none is in doubt.
std::string doubt_text(const Continuation& rest, const std::string& item);

/// "continue with --from 687 (points 503 to 686 may have been fired)". `is_kept`: the journal has
/// the progress of the job, so that --resume can ask the board.
std::string continuation_text(const Continuation& rest, const std::string& item, bool is_kept);

}  // namespace lamplock::link
