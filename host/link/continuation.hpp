// Where a job goes on after an end before its end, and which of its points are in doubt.
//
// In:  what the board has told last, what was handed to it, the mark of a restart.
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

#include "firmware/motion/target.hpp"
#include "host/job/job.hpp"
#include "host/link/restart_mark.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// The rest of a job. Items are points, or lines of a job of rows.
struct Continuation {
  std::size_t first = 0;      ///< all items before it are done, as often as ordered
  std::uint32_t flashes = 0;  ///< of that point that were fired; 0 if it is in doubt
  std::size_t from = 0;       ///< from here on nothing was done; first <= from
  /// The board was at rest when it reported, or has marked its restart. Otherwise `first` is a
  /// lower bound, and the board may know more.
  bool settled = false;

  bool in_doubt() const { return from > first; }
};

/// The board is at rest: no job is unfinished, or an alarm has ended it. Out of these states only
/// another job or the user at the machine leads to motion.
bool stands(wire::MachineState state);

/// The board is at rest and has reported the first item not done. A line of pixels in which
/// it has come to rest is burnt in part.
Continuation at_rest(const job::Job& job, std::size_t first, std::uint32_t flashes);

/// The board has restarted by itself. It does not know how many flashes of the point were fired.
Continuation after_restart(const job::Job& job, const RestartMark& mark);

/// Flashes of point `next` among `shots` that begin at point `from` of the targets.
std::uint32_t flashes_of(std::span<const motion::Target> targets, std::size_t from,
                         std::size_t next, std::uint64_t shots);

/// "--from 12 --fired 3"
std::string go_on_options(const Continuation& rest);

/// "points 503 to 686 may have been fired"; empty if none is in doubt.
std::string doubt_text(const Continuation& rest, const std::string& item);

/// "go on with --from 687 (points 503 to 686 may have been fired)". `is_kept`: the progress of the
/// job is in a journal, with which the board can be asked.
std::string go_on_text(const Continuation& rest, const std::string& item, bool is_kept);

}  // namespace lamplock::link
