// `lamplock chip`: any image for the RP2040 in the chip simulator; a program of its own,
// lamplock-chip.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::chip_tool {

/// Adds the command with its options.
void add_chip(cli::Command& program);

}  // namespace lamplock::chip_tool
