// Macros: lines of G-code that a key sends, and the check of these lines.
//
// In:  lines of a key map. Out: lines as they are sent, or an error.
// Who: the key map. A key may be hit by accident: without `laser` in the map no macro may turn on a
//      laser, switch an output, or change settings of the machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// Lines of one key; each is sent after the answer to the one before.
struct Macro {
  std::string name;
  std::vector<std::string> lines;
  bool laser = false;  ///< words that turn on the laser are allowed
};

/// The first word of a line that may turn on a laser or switch an output: S, and every M but M0 M1
/// M2 M5 M7 M8 M9 M30 M60; empty if there is none. Words may be written as the board reads them, "m
/// 05". Text that is not a word (expressions of other boards, lists of powers) counts as one: "?".
std::string laser_word(std::string_view line);

/// A line as it is sent. Throws Error(bad_input) about `where`: `$` lines other than $H, $X and
/// $J=; real-time bytes; laser words without `laser`; a line too long for a board.
std::string macro_line(std::string_view line, bool laser, const std::string& where);

}  // namespace lamplock::pendant
