// Parses the text lines of a board: answers, status reports, alarms, options.
//
// In:  a line without its end, as grbl 1.1 and grblHAL write it. Out: its values.
// Who: all readers of a LinePort. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::link {

/// A status report, `<Run|MPos:1.000,2.000,0.000|Bf:15,128|...>`. Missing fields are empty; unknown
/// fields are ignored.
struct BoardStatus {
  std::string state;             ///< without its number: "Idle", "Hold"
  int substate = -1;             ///< the number after the state; -1 = none
  std::vector<double> position;  ///< MPos, or WPos
  bool of_work = false;          ///< the position is WPos
  std::vector<double> work_offset;
  std::optional<std::size_t> free_lines, free_bytes;  ///< Bf: of the planner, of the buffer
  double feed = 0, speed = 0;                         ///< FS: mm/min, spindle speed or power
  std::vector<int> overrides;                         ///< Ov: feed, rapid, spindle, per cent
  std::size_t line = 0;  ///< Ln: N word of the line that is executed; 0 = none

  bool is(std::string_view name) const { return state == name; }
  /// The machine is at rest until the user or the host sends a command.
  bool is_at_rest() const { return rests() || waits() || is("Alarm") || is("Sleep"); }
  /// The machine is at rest and every line has been executed.
  bool rests() const { return is("Idle") || is("Check"); }
  /// The machine is at rest and waits for a resume: Hold:0 (a hold, a pause of the program), Door:0
  /// and Door:1 (closed, open), Tool (a tool change).
  bool waits() const {
    return (is("Hold") && substate <= 0) || (is("Door") && substate <= 1) || is("Tool");
  }
};

/// Empty if the line is no status report.
std::optional<BoardStatus> parse_status(std::string_view line);

/// "ok" is 0, "error:N" is N; empty if the line is no answer.
std::optional<int> parse_answer(std::string_view line);
/// N of "ALARM:N".
std::optional<int> parse_alarm(std::string_view line);
/// True for the line that a board sends after a reset: "Grbl 1.1h ['$' for help]".
bool is_banner(std::string_view line);

/// The answer to `$I`.
struct BoardIdentity {
  std::string version;            ///< text of [VER:]
  std::string options;            ///< letters of [OPT:]
  std::size_t planner_lines = 0;  ///< that it has room for; 0 = not reported
  std::size_t window_bytes = 0;   ///< of the receive buffer; 0 = not reported
};

/// Reads a line of the answer to `$I`; false if the line is another one.
bool take_identity(std::string_view line, BoardIdentity& identity);

/// A line in words for the user: the text of "[MSG:text]", an alarm with its meaning, other lines
/// as they are.
std::string message_text(std::string_view line);
/// "error:N" with its meaning.
std::string error_text(int number);
/// "ALARM:N" with its meaning.
std::string alarm_text(int number);

}  // namespace lamplock::link
