// Roles of the computer's lines.
//
// In:  a file (read_line_table.hpp). Out: requests by role.
// Who: inputs and outputs of a job (safety_inputs.hpp), reset and boot lines (board_lines.hpp), the
//      command line.
#pragma once

#include <chrono>
#include <optional>

#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// Lines by role; a role without a line is not used.
struct LineTable {
  std::optional<LineRequest> estop{};      ///< input, active: pressed, or its wire broken
  std::optional<LineRequest> door{};       ///< input, active: open, or its wire broken
  std::optional<LineRequest> interlock{};  ///< output, active: a job runs and all inputs are well
  std::optional<LineRequest> lamp{};       ///< output, active: status lamp on
  std::optional<LineRequest> run{};        ///< output, active: the board is in reset
  std::optional<LineRequest> bootsel{};    ///< output, active: as with its BOOTSEL button pressed
  /// An input counts as released after this time without edges.
  std::chrono::milliseconds debounce{20};
  /// Not 0: while the interlock is on its line changes at this interval, for a relay that releases
  /// when the changes end.
  std::chrono::milliseconds interlock_beat{0};

  /// A job has lines to read or to switch.
  bool guards() const { return estop || door || interlock || lamp; }
};

}  // namespace lamplock::gpio
