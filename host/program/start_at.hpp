// Starts a program in its middle: `send --from`.
//
// In:  the lines of a program, the number of the first one to run, the settings of the machine.
// Out: lines that move the machine to the position of the program there and set the modal state of
//      the lines before, then the rest of the program. Who: `lamplock send`.
//
// The interpreter of the firmware runs the skipped lines without a machine. The approach is a rapid
// with the laser off: X, Y and A together, then Z. The laser or spindle is switched on after it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

/// `first` is a line of the file, from 1. Throws Error(bad_input): there is no such line, a line
/// before it has an error or cannot be skipped, or the state at `first` is unknown or needs more
/// than lines before it (skipped_lines.hpp). `state`: of the board before the first line of
/// the program, if known.
std::vector<link::ProgramLine> start_at(const std::vector<link::ProgramLine>& lines,
                                        std::size_t first, const settings::Values& values,
                                        const std::string& file,
                                        const std::optional<BoardState>& state = {});

}  // namespace lamplock::program_run
