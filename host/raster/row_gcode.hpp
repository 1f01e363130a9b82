// Rows of pixels as a program of G-code, for boards and senders that do not know the pulse stream:
// a line for each stretch of one power, which every grbl reads; or lists of powers (docs/gcode.md),
// at most a third as long, which only this firmware reads.
//
// In:  a job of rows. Out: text. Who: `lamplock raster --gcode`.
#pragma once

#include <cstdint>
#include <string>

#include "host/job/job.hpp"

namespace lamplock::raster {

enum class PowerForm : std::uint8_t { plain, lists };

/// The same lines with the same cells, in work coordinates that are those of the machine. Lists too
/// long for one line of text are several, cut between cells.
std::string row_gcode(const job::Job& job, PowerForm form);

}  // namespace lamplock::raster
