// Talk with a board that somebody moves by hand: what waits for its answer, how the machine is.
//
// In:  lines and real-time bytes; what the board says. Out: answers in order, each with its line;
//      messages for people; the last status, asked for all the time.
// Who: the jog stream and the jogger. Never waits: poll() is one round of a loop.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::pendant {

using Time = std::chrono::microseconds;

/// Reports that must say that the machine stands: the first may have been on its way already.
inline constexpr std::size_t sure_reports = 2;

/// What a line was, for whoever gets its answer.
enum class LineKind : std::uint8_t { jog, command };

/// An answer of the board.
struct Answered {
  LineKind kind;
  std::string line;
  int error = 0;  ///< 0: ok
};

/// How the machine is, as far as it has told.
struct MachineNow {
  link::BoardStatus status;         ///< the last report
  std::vector<double> work_offset;  ///< mm, of the last report that had one
  std::vector<int> overrides;       ///< likewise: feed, rapid, power, per cent
  std::size_t reports = 0;          ///< so many have come

  /// Machine or work coordinates, mm; empty before the first report.
  std::vector<double> place(bool of_work) const;
};

/// One conversation; the port must outlive it.
class BoardTalk {
 public:
  explicit BoardTalk(link::LinePort& port) : port_(port) { heard_at_ = now(); }

  Time now() const { return port_.transport().now(); }
  void send(std::string_view line, LineKind kind);
  /// Goes before all lines.
  void send_byte(std::uint8_t byte) { port_.send_realtime(byte); }
  /// Lines that have not begun to go do not go; what they were, in order.
  std::vector<Answered> drop_lines();
  /// After a reset: nothing sent before is answered any more.
  void forget_lines();

  /// Reads what has come, asks for the status, writes what is to go. `hurry`: the machine moves by
  /// hand, and is asked more often. Throws Error(no_device): cut off, or silent for 5 s.
  std::vector<Answered> poll(bool hurry);
  /// Lines for people that have come since the last call: alarms, [MSG:...].
  std::vector<std::string> take_messages();
  /// How often the board has begun anew; what was sent before is forgotten then.
  std::size_t restarts() const { return restarts_; }

  /// The board has said something a moment ago (250 ms).
  bool answers() const;
  /// Lines that it has not answered yet.
  std::size_t unanswered(LineKind kind) const;
  /// One of them is homing.
  bool homing_unanswered() const;
  /// A line has begun to go and is not out as a whole.
  bool inside_line() const { return port_.inside_line(); }
  const MachineNow& machine() const { return machine_; }

 private:
  void take(const std::string& line, std::vector<Answered>& answers);
  void take_status(const link::BoardStatus& status);

  link::LinePort& port_;
  std::deque<Answered> sent_;
  MachineNow machine_;
  std::vector<std::string> messages_;
  std::size_t restarts_ = 0;
  Time heard_at_{}, asked_at_{};
};

}  // namespace lamplock::pendant
