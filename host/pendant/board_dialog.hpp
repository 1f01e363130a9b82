// Communication with a board during manual motion: lines without answer, status of the machine.
//
// In:  lines and real-time bytes; lines from the board. Out: answers in order, each with its line;
//      messages for the user; the last status, requested regularly.
// Who: the jog stream and the jogger. Never blocks: poll() is one round of a loop.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::pendant {

using Time = std::chrono::microseconds;

/// Reports in a row that must say that the machine is at rest: the first may be older than the
/// stop.
inline constexpr std::size_t sure_reports = 2;

/// Kind of a line, for the receiver of its answer.
enum class LineKind : std::uint8_t { jog, command };

/// An answer of the board.
struct Answered {
  LineKind kind;
  std::string line;
  int error = 0;  ///< 0: ok
};

/// The machine's state as reported.
struct MachineNow {
  link::BoardStatus status;         ///< the last report
  std::vector<double> work_offset;  ///< mm, of the last report that had one
  std::vector<int> overrides;       ///< likewise: feed, rapid, power, per cent
  std::size_t reports = 0;          ///< number of reports received

  /// Machine or work coordinates, mm; empty before the first report.
  std::vector<double> place(bool of_work) const;
};

/// Communication with one board; the port must outlive it.
class BoardDialog {
 public:
  explicit BoardDialog(link::LinePort& port) : port_(port) { heard_at_ = now(); }

  Time now() const { return port_.transport().now(); }
  void send(std::string_view line, LineKind kind);
  /// Queues a real-time byte before all lines.
  void send_byte(std::uint8_t byte) { port_.send_realtime(byte); }
  /// Drops lines of which no byte was sent; returns them in order.
  std::vector<Answered> drop_lines();
  /// Drops all lines, after a reset: the board does not answer lines sent before.
  void forget_lines();

  /// Reads, requests the status, writes. `hurry`: the machine moves by hand, and the interval of
  /// requests is shorter. Throws Error(no_device): connection cut, or silent for 5 s.
  std::vector<Answered> poll(bool hurry);
  /// Messages for the user since the last call: alarms, [MSG:...].
  std::vector<std::string> take_messages();
  /// Calls `show` with every line that is neither a status report nor an answer.
  void on_line(std::function<void(const std::string&)> show) { on_line_ = std::move(show); }
  /// Number of restarts of the board; each one drops the lines sent before.
  std::size_t restarts() const { return restarts_; }

  /// The board has sent a line within the last 250 ms.
  bool answers() const;
  /// Number of lines that the board has not answered yet.
  std::size_t unanswered(LineKind kind) const;
  /// One of them is homing.
  bool homing_unanswered() const;
  /// A line was sent in part.
  bool inside_line() const { return port_.inside_line(); }
  const MachineNow& machine() const { return machine_; }

 private:
  void take(const std::string& line, std::vector<Answered>& answers);
  void take_status(const link::BoardStatus& status);

  link::LinePort& port_;
  std::deque<Answered> sent_;
  MachineNow machine_;
  std::vector<std::string> messages_;
  std::function<void(const std::string&)> on_line_;
  std::size_t restarts_ = 0;
  Time heard_at_{}, asked_at_{};
};

}  // namespace lamplock::pendant
