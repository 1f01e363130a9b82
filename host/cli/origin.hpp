// Where the origin of a job lies on the machine: its own, or the zero that the operator has taught.
//
// In:  --origin; the board. Out: the way from one to the other. Who: `engrave`, `frame`.
#pragma once

#include <optional>
#include <string>

#include "host/cli/command_line.hpp"
#include "host/link/transport.hpp"
#include "host/points/point.hpp"

namespace lamplock::cli {

/// --origin machine|zero.
struct OriginOption {
  std::string name = "machine";

  void add(Command& app);
  /// The taught zero (`lamplock operate zero`) in machine coordinates, mm; nothing for the
  /// machine's own origin. Simulated boards (no port) have been taught nothing: all zero. Asks the
  /// board. Throws Error: no_device, job_failed (also where G92 shifts coordinates).
  std::optional<points::Point> ask(link::Transport* port) const;
};

}  // namespace lamplock::cli
