// The options of the command line that describe simulated servo drives.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"
#include "host/run/diagnose.hpp"

namespace lamplock::cli {

/// Pulses, lengths, encoder and dynamics, with the present values as defaults; `y_default`: of the
/// time constant of Y.
void add_servo_drives(Command& app, program_run::ServoMachine& machine,
                      const std::string& y_default);

}  // namespace lamplock::cli
