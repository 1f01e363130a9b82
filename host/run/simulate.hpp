// A simulated board on a port of this computer, at the pace of the wall clock.
//
// In:  which board, which ports, files. Out: the board, until the user or a time limit ends it.
// Who: `sim`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/lost_files.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/simulated_boards.hpp"

namespace lamplock::run {

struct SimOptions {
  std::string board = virtual_board, image, pty, tcp, vcd, shots;
  std::optional<double> seconds;
  MachineOptions machine;
  LampFaults faults;
  SimulatedSpot spot{};
  SimulatedDrives drives;
};

struct Simulated {
  std::size_t shots = 0;
  std::int64_t flashes = 0;
  LostFiles lost{};
};

/// Throws Error if a port cannot be opened or a file cannot be written. A file that cannot be
/// written after the simulation is lost.
Simulated simulate(const SimOptions& options, Frontend& frontend);

}  // namespace lamplock::run
