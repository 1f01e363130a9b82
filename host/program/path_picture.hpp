// A picture of the path of a program, seen from above, with power in colour, as SVG.
//
// In:  a run of a program, a title. Out: text of an SVG file; some 20 bytes a piece.
// Who: `lamplock check --picture`.
//
// Rapids are thin and dashed. Powers have 32 shades, from light to dark; the darkest is the
// program's maximum power. Pieces too short to be visible are left out.
#pragma once

#include <string>

#include "host/program/program_run.hpp"

namespace lamplock::program_run {

/// The picture. `title` is plain text.
std::string path_svg(const ProgramRun& run, const std::string& title);

}  // namespace lamplock::program_run
