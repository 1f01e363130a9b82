// Messages in comments: (MSG, text), (DEBUG, text #1), (PRINT, text #<name>).
//
// In:  a line, the parameters after it.
// Out: their texts, one at a time; in those of DEBUG and PRINT values replace parameters, and %d,
//      %f, %.3f, %lf say with how many decimals: 0, 4, 3, 6 (LinuxCNC, "G-code Overview", 13.6:
//      messages, debug and print messages, parameters in special comments).
// Who: the console and the host, after a line has been accepted.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/program/expression.hpp"
#include "shared/text_line.hpp"

namespace lamplock::program {

/// Longest text; the rest is cut.
inline constexpr std::size_t max_message = 240;

/// Removes the line up to the end of its next message and adds the text of that; false if there is
/// none left.
[[gnu::cold]] bool take_message(std::string_view& line, Expressions& expressions, TextLine& text);

}  // namespace lamplock::program
