// What a running board is asked over its port around flashing: whether it may be stopped, its
// version, the way to its boot loader.
//
// In:  an open transport. Out: the answers, or an Error that says why not now.
// Who: Update. The firmware's side: `$BOOT`, which it takes at rest only (docs/wiring.md).
#pragma once

#include <string>

#include "host/link/transport.hpp"

namespace lamplock::flash {

/// How long a board may be silent before it counts as one that does not answer.
enum class Asked {
  briefly,     ///< 3 s: nothing is done to it then
  to_be_sure,  ///< 12 s: a job over the pulse stream whose host has died is heard of too
};

/// The version of a board that rests. Nothing but a status request, which may come between any two
/// bytes, is sent before it has said that it does. Throws Error: job_failed while it does
/// something or if its port goes meanwhile, no_device if it does not answer. `where`: for errors.
std::string version_at_rest(link::Transport& transport, const std::string& where, Asked asked);

/// Sends it to its boot loader; it leaves the bus soon afterwards. Throws Error(job_failed) if it
/// refuses, no_device if it does not answer.
void enter_boot_loader(link::Transport& transport, const std::string& where);

/// The version of a board that has just started. Throws Error(no_device).
std::string version(link::Transport& transport);

}  // namespace lamplock::flash
