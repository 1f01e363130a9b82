// Removes the laser from a program without a change of its motion: `send --dry`.
//
// In:  the lines of a program. Out: the same without the words that switch a laser or spindle on
//      (M3, M4, S and its lists), after an M5. Who: `lamplock send`.
#pragma once

#include <string>
#include <vector>

#include "host/link/program_lines.hpp"

namespace lamplock::program_run {

/// Throws Error(bad_input) about FILE:LINE for words that may fire without a spindle word: points
/// on the beat (M130), outputs (M62 to M68), and `$` lines that change settings.
std::vector<link::ProgramLine> without_laser(const std::vector<link::ProgramLine>& lines,
                                             const std::string& file);

}  // namespace lamplock::program_run
