// Where the origin of a job lies on the machine: in the machine's own, or in the taught zero.
//
// In:  --origin; the board. Out: the offset between the two. Who: `engrave`, `estimate`, `frame`.
#pragma once

#include <optional>
#include <string>

#include "host/geometry/point.hpp"
#include "host/link/transport.hpp"

namespace lamplock::run {

/// The two choices of --origin.
inline constexpr const char* origin_machine = "machine";
inline constexpr const char* origin_zero = "zero";

/// The taught zero (`lamplock operate zero`) in machine coordinates, mm; nothing for
/// origin_machine. A simulated board (no port) has no taught zero: all coordinates are 0. Asks the
/// board. Throws Error: no_device, job_failed (also where G92 shifts coordinates).
std::optional<geometry::Point> ask_origin(const std::string& name, link::Transport* port);

}  // namespace lamplock::run
