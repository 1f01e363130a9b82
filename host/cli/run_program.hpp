// Sends a program of G-code to a board and tells how it went: the other half of `send`.
//
// In:  a file, where to run it. Out: the run, told on the console; the exit status.
// Ctrl-C stops: the machine is held and reset once it stands.
#pragma once

#include <string>

#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace lamplock::cli {

/// What `send` was asked about a program.
struct ProgramOptions {
  bool go_on = false;  ///< after errors
  MachineOptions machine{};
};

/// True for the names that programs of G-code have: .gcode .nc .ngc .gc .tap .cnc
bool is_program(const std::string& file);

/// Sends it and sees it through. Throws Error if it cannot be sent, or did not end well.
Exit send_program(const std::string& file, const BoardOptions& options,
                  const ProgramOptions& program);

}  // namespace lamplock::cli
