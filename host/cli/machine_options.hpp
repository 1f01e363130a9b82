// The options of the command line that choose a machine.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::cli {

void add_machine(Command& app, run::MachineOptions& options);  ///< --machine alone
void add_machine_overrides(Command& app,
                           run::MachineOptions& options);  ///< lamp, acceleration, speed

}  // namespace lamplock::cli
