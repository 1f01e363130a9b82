// Checks the name of a board before it is opened.
//
// In:  what was given to --board, the ports of this computer. Out: an error with the names that are
//      nearest, and the ports. Who: everything that opens a board.
#pragma once

#include <string>
#include <vector>

namespace lamplock::run {

/// What to do about an unknown name: "did you mean 'virtual'? (serial ports of this computer:
/// /dev/ttyACM0)".
std::string remedy_for_name(const std::string& name, const std::vector<std::string>& ports);

/// Serial ports over USB, sorted.
std::vector<std::string> serial_ports();

/// Throws Error(bad_input) for what is neither the name of a board, a file, nor HOST:PORT.
void check_board_name(const std::string& name);

}  // namespace lamplock::run
