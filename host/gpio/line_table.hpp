// Which lines of the computer do what.
//
// In:  a file (read_line_table.hpp). Out: requests by role.
// Who: the guard of jobs (guard.hpp), reset and boot lines (board_lines.hpp), the command line.
#pragma once

#include <chrono>
#include <optional>

#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// Lines by what they are for; those that are not named are not used.
struct LineTable {
  std::optional<LineRequest> estop{};      ///< input, active: pressed, or its wire broken
  std::optional<LineRequest> door{};       ///< input, active: open, or its wire broken
  std::optional<LineRequest> interlock{};  ///< output, active: a job runs and all is well
  std::optional<LineRequest> lamp{};       ///< output, active: light of the status lamp
  std::optional<LineRequest> run{};        ///< output, active: the board is in reset
  std::optional<LineRequest> bootsel{};    ///< output, active: as with its BOOTSEL button pressed
  /// An input has to be quiet for so long before it counts as released.
  std::chrono::milliseconds debounce{20};
  /// Not 0: while the interlock is on its line changes this often, for a relay that falls when the
  /// changes end.
  std::chrono::milliseconds interlock_beat{0};

  /// A job has something to look at or to switch.
  bool guards() const { return estop || door || interlock || lamp; }
};

}  // namespace lamplock::gpio
