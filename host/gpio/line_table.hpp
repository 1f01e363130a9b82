// Which lines of the computer do what: the file that `--lines` names, or [lines] of a machine
// profile.
//
// In:  a TOML file (examples/lines.toml). Out: requests by role.
// Who: the guard of jobs (guard.hpp), reset and boot lines (board_lines.hpp), the command line.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string_view>

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

/// Takes the text of such a file apart; `file` names it in errors. Throws Error(bad_input) with
/// file, line, key and what it may be; two roles on one line, too.
LineTable parse_line_table(std::string_view text, const std::filesystem::path& file);

/// Reads a file. Throws as parse_line_table().
LineTable read_line_table(const std::filesystem::path& file);

/// What a machine profile says under `lines`: [lines.estop] and so on; no lines if it says nothing.
/// Throws as parse_line_table().
LineTable read_machine_lines(const std::filesystem::path& profile);

}  // namespace lamplock::gpio
