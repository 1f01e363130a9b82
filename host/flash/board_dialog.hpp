// Dialog with a running board before and after flashing: whether it is at rest, its version, the
// command to enter its boot loader.
//
// In:  an open transport. Out: the answers, or an Error that says why flashing must wait.
// Who: Update. The firmware accepts `$BOOT` at rest only (docs/wiring.md).
#pragma once

#include <string>

#include "host/link/transport.hpp"

namespace lamplock::flash {

/// Time until a silent board counts as one that does not answer.
enum class Asked {
  briefly,     ///< 3 s: enough if a silent board is left alone
  to_be_sure,  ///< 12 s: longer than a job over the pulse stream lasts after its host has died
};

/// The version of a board at rest. Before it has reported rest, only status requests are sent,
/// which are allowed between any two bytes. Throws Error: job_failed if the board is not at rest or
/// its port disappears meanwhile, no_device if it does not answer. `where`: for errors.
std::string version_at_rest(link::Transport& transport, const std::string& where, Asked asked);

/// Makes the board enter its boot loader; it leaves the bus soon afterwards. Throws
/// Error(job_failed) if it refuses, no_device if it does not answer.
void enter_boot_loader(link::Transport& transport, const std::string& where);

/// The version of a board that has just started. Throws Error(no_device).
std::string version(link::Transport& transport);

}  // namespace lamplock::flash
