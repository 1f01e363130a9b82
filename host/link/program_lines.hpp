// Splits a G-code program into lines to send.
//
// In:  the text of a file. Out: its lines with their numbers, without comments and blanks.
// Who: senders of programs, the console.
//
// Comments must not be sent: a board executes `?`, `!`, `~` and bytes from 0x80 up as real-time
// commands anywhere in a line, and a comment may contain any of them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::link {

/// A line of a program that is not blank.
struct ProgramLine {
  std::size_t number = 0;  ///< in the file, from 1
  std::string text;        ///< without comments; empty for a line of messages alone
  /// Comments that a board reports, `(MSG, text)` and so on, of this line and blank ones before it.
  std::string messages{};
  std::string origin{};  ///< FILE:LINE, of a line from another file than the program's
  /// Comments `(probeopen NAME)` and `(probeclose)` of this line and of blank ones before it.
  std::vector<std::string> logs{};
  std::string source{};  ///< the line in its file, if it differs from `text`; empty: not known
};

/// The lines with their numbers in the file as N words, in place of their own, so that a board
/// reports the line that it executes. Lines that begin otherwise than with a word of a block (`$`,
/// `%`, `/`, `:`) stay as they are; lines that would be longer than a board accepts
/// (shared/wire/framing.hpp) have no number.
/// Messages follow their line if there is room.
std::vector<ProgramLine> with_numbers(std::vector<ProgramLine> lines);

/// The lines, with messages in lines of their own before a line that has no room for them or cannot
/// hold them: a `$` line, or one for which `holds_none` is true, which the board does not get.
std::vector<ProgramLine> separate_messages(
    std::vector<ProgramLine> lines, const std::function<bool(const std::string&)>& holds_none = {});

/// The line without comments (brackets, semicolon) and white space at both ends; in `$` lines text
/// that looks like a comment stays. Throws Error(bad_input) about `where` if it has a byte that a
/// board would execute as a real-time command, with this remedy.
std::string line_to_send(
    std::string_view line, const std::string& where,
    const std::string& remedy = "remove it, and check that the file is a G-code program");

/// NAME of a comment `probeopen NAME` of ProgramLine::logs; empty for `probeclose`.
std::string probe_log_name(std::string_view comment);

/// Why a line of a program, without its comments, must not be sent: a byte of it is a real-time
/// command. Empty if there is none.
std::string realtime_fault(std::string_view text);

/// The line without comments and white space at both ends, as line_to_send() but unchecked.
std::string text_to_send(std::string_view line);

/// Where a column of text_to_send(line) is in the line, both from 1. 0 for a column outside of it.
std::size_t column_in_line(std::string_view line, std::size_t column);

/// The character, `(` or `;`, of the comment that has begun in this text, the begin of a line, and
/// has not ended: a character that is added would be part of it. 0 without such a comment; `$`
/// lines have none.
char open_comment(std::string_view line);

/// Splits a program; lines end in CR, LF or both. Blank lines and lines of `%` are left out, except
/// those whose messages are not joined to the line after them: it could change the values that they
/// show, or has no room. Throws Error(bad_input) about FILE:LINE as line_to_send(), and for a probe
/// log whose name is not that of a file in a folder: empty, `..`, with a path.
std::vector<ProgramLine> program_lines(std::string_view text, const std::string& file);

/// True if the line pauses the program: M0, M1 or M60; or may, by an expression.
bool is_pause(std::string_view line);

/// True if the line is M130, after which points are on the beat; or may be, by an expression.
bool may_lock_to_beat(std::string_view line);

/// True if the board answers the line after it has executed it and all lines before: a dwell, a
/// pause, a probe, the end of the program, a tool change, M66, `$H`.
bool runs_at_rest(std::string_view line);

/// Sum of the P words of a line, at least 0: its longest possible dwell time in seconds; an hour
/// more if P is an expression.
double max_dwell_s(std::string_view line);

}  // namespace lamplock::link
