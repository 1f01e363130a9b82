// What a board says in lines of text, taken apart: answers, status reports, alarms, options.
//
// In:  a line without its end, as grbl 1.1 and grblHAL write it. Out: what it means.
// Who: whoever reads from a LinePort. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::link {

/// A status report, `<Run|MPos:1.000,2.000,0.000|Bf:15,128|...>`. Fields that are not there are
/// empty; unknown ones are passed over.
struct BoardStatus {
  std::string state;             ///< without its number: "Idle", "Hold"
  int substate = -1;             ///< the number behind it; -1 = none
  std::vector<double> position;  ///< MPos, or WPos
  bool of_work = false;          ///< the position is WPos
  std::vector<double> work_offset;
  std::optional<std::size_t> free_bytes;  ///< Bf
  double feed = 0, speed = 0;             ///< FS: mm/min, spindle speed or power
  std::vector<int> overrides;             ///< Ov: feed, rapid, spindle, per cent

  bool is(std::string_view name) const { return state == name; }
  /// Nothing moves, and nothing will without somebody's doing.
  bool stands() const { return rests() || waits() || is("Alarm") || is("Sleep"); }
  /// Nothing moves and everything has been done.
  bool rests() const { return is("Idle") || is("Check"); }
  /// Stands and waits for somebody to say that it may go on: Hold:0 (a hold, a pause of the
  /// program), Door:0 and Door:1 (closed, open).
  bool waits() const { return (is("Hold") && substate <= 0) || (is("Door") && substate <= 1); }
};

/// Nothing if the line is no status report.
std::optional<BoardStatus> parse_status(std::string_view line);

/// "ok" is 0, "error:N" is N; nothing if the line is no answer.
std::optional<int> parse_answer(std::string_view line);
/// N of "ALARM:N".
std::optional<int> parse_alarm(std::string_view line);
/// True for the line that a board begins with: "Grbl 1.1h ['$' for help]".
bool is_banner(std::string_view line);

/// What `$I` tells.
struct BoardIdentity {
  std::string version;           ///< what stands in [VER:]
  std::string options;           ///< letters of [OPT:]
  std::size_t window_bytes = 0;  ///< of the receive buffer; 0 = not told
};

/// Takes what a line of `$I` tells; false if it is none.
bool take_identity(std::string_view line, BoardIdentity& identity);

/// "error:N" with what it means.
std::string error_text(int number);
/// "ALARM:N" with what it means.
std::string alarm_text(int number);

}  // namespace lamplock::link
