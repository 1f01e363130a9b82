// Macros: lines of G-code that a key sends, and what may be in them.
//
// In:  lines of a key map. Out: lines as they are sent, or what is wrong with one.
// Who: the key map. A key is hit by accident: without leave in the map no macro lights a laser,
//      switches an output, or changes what the machine is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// What one key sends, line by line, each when the one before has been answered.
struct Macro {
  std::string name;
  std::vector<std::string> lines;
  bool laser = false;  ///< may have words that light the laser
};

/// The first word of a line that may light a laser or switch an output: S, and every M but M0 M1 M2
/// M5 M7 M8 M9 M30 M60; empty if there is none. Words may be written as the board reads them, "m
/// 05". What is no word (expressions of other boards, lists of powers) counts as one: "?".
std::string laser_word(std::string_view line);

/// A line as it is sent. Throws Error(bad_input) about `where`: `$` lines other than $H, $X and
/// $J=; bytes that are commands to a board; laser words without `laser`; a line too long for a
/// board.
std::string macro_line(std::string_view line, bool laser, const std::string& where);

}  // namespace lamplock::pendant
