// Rows of pixels as a G-code program, for boards and senders without the pulse stream: a line for
// each stretch of one power, which every grbl reads; or lists of powers (docs/gcode.md), at most a
// third as long, which only this firmware reads.
//
// In:  a job of rows. Out: text. Who: `lamplock raster --gcode`.
#pragma once

#include <cstdint>
#include <string>

#include "host/job/job.hpp"

namespace lamplock::raster {

enum class PowerForm : std::uint8_t { plain, lists };

/// The same lines with the same cells, in work coordinates equal to machine coordinates. Lists too
/// long for one line of text are split between cells. A dry job becomes a program without light:
/// its rows have no powers, and the laser is off.
std::string row_gcode(const job::Job& job, PowerForm form);

}  // namespace lamplock::raster
