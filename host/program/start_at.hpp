// A program that begins in its middle: `send --from`.
//
// In:  the lines of a program, the number of the first one to run, the settings of the machine.
// Out: lines that bring the machine to where the program is there and put into force what the lines
//      before have said, then the rest of the program. Who: `lamplock send`.
//
// The interpreter of the firmware runs the lines that are left out, without a machine. The approach
// is a rapid with the laser off: X, Y and A together, then Z. The laser or spindle is switched on
// after it.
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
/// before it is wrong, or does what cannot be left out (offsets, probing, points on the beat, lines
/// for the board), or the place at `first` is not known. `state`: of the board before the first
/// line of the program, if it is known.
std::vector<link::ProgramLine> start_at(const std::vector<link::ProgramLine>& lines,
                                        std::size_t first, const settings::Values& values,
                                        const std::string& file,
                                        const std::optional<BoardState>& state = {});

}  // namespace lamplock::program_run
