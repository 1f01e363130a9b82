// Rows of pixels as a program of G-code: lines of pixels (docs/gcode.md), for boards and senders
// that do not know the pulse stream.
//
// In:  a job of rows. Out: text. Who: `lamplock raster --gcode`.
#pragma once

#include <string>

#include "host/job/job.hpp"

namespace lamplock::raster {

/// The same lines with the same cells, in work coordinates that are those of the machine. Lines too
/// long for one line of text are several, cut between cells.
std::string row_gcode(const job::Job& job);

}  // namespace lamplock::raster
