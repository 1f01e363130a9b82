// A program of G-code as lines to send.
//
// In:  the text of a file. Out: its lines with their numbers, without comments and blanks.
// Who: senders of programs, the console.
//
// Comments must not go out: a board takes `?`, `!`, `~` and bytes from 0x80 up for commands
// wherever they stand, and a comment may have any of them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::link {

/// A line of a program that says something.
struct ProgramLine {
  std::size_t number = 0;  ///< in the file, from 1
  std::string text;
};

/// What goes out for a line: without comments (brackets, semicolon) and white space at both ends;
/// `$` lines keep what looks like a comment. Throws Error(bad_input) about `where` if it has a byte
/// that a board would take for a command.
std::string line_to_send(std::string_view line, const std::string& where);

/// Takes a program apart; lines end in CR, LF or both. Blank lines and lines of `%` are left
/// out. Throws Error(bad_input) about FILE:LINE as line_to_send().
std::vector<ProgramLine> program_lines(std::string_view text, const std::string& file);

/// True if the line pauses the program: M0, M1 or M60.
bool is_pause(std::string_view line);

/// Sum of the P words of a line, at least 0: how long it may dwell, seconds.
double longest_dwell_s(std::string_view line);

}  // namespace lamplock::link
