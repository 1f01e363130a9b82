// A conversation with a board: lines as somebody types them, and words for real-time bytes.
//
// In:  typed lines; what the board says. Out: lines to the board, one at a time, each when the one
//      before has been answered; everything the board says, to be shown.
// Who: `lamplock console`. No port of its own, no terminal: tests talk to it as well.
//
// Typed by hand, real-time words go out at once, before the lines that were typed earlier and wait
// for their turn. A hold also stops these lines until a resume, a jog cancel discards the jogs
// among them, and a reset discards them all. In order, as a script wants it, each word waits for
// its turn, and the first error or alarm ends the conversation; but while the machine pauses in the
// middle of a line, words behind it go out, or it would wait for ever.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "host/link/line_port.hpp"

namespace lamplock::link {

/// The byte of a real-time word: `?` `!` `~`, or `:hold`, `:feed +10` and so on; nothing if it is
/// none. Throws Error(bad_input) for an unknown word that begins with a colon.
std::optional<std::uint8_t> realtime_word(std::string_view typed);
/// All words, for a help text.
std::string realtime_words();

/// How a conversation went wrong.
struct ConsoleFailure {
  std::size_t line = 0;  ///< the typed one it is about, from 1
  std::string text;      ///< what the board said, with its meaning
};

/// One conversation; the port must outlive it.
class LineConsole {
 public:
  using Show = std::function<void(const std::string&)>;
  LineConsole(LinePort& port, bool in_order, Show show)
      : port_(port), in_order_(in_order), show_(std::move(show)) {}

  /// Takes a typed line. Throws Error(bad_input) as realtime_word() and line_to_send().
  void type(const std::string& line);
  /// One round: reads, shows, sends, waits a little. Throws Error(no_device): the board is gone or
  /// does not answer.
  void step();
  /// Typed lines that have not been sent.
  std::size_t queued() const { return queue_.size(); }
  /// Everything typed has been sent and answered.
  bool done() const;
  /// Nothing more will be typed: step() asks for the status until the machine is at rest. A board
  /// whose port is closed while it moves holds.
  void end_input() { input_ended_ = true; }
  /// The board has reported that it is at rest, or has not answered the question.
  bool at_rest() const { return at_rest_; }
  /// The first error or alarm; with in_order nothing is sent behind it.
  const std::optional<ConsoleFailure>& failure() const { return failure_; }

 private:
  using Time = std::chrono::microseconds;
  enum class Waiting : std::uint8_t { nothing, answer, status, banner };
  struct Typed {
    std::size_t number;
    std::string text;
  };

  void take(const std::string& line);
  void fail(const std::string& text);
  void send_next();
  void send_word_behind_pause();
  void send_byte(std::uint8_t byte);
  void hold_queue(std::uint8_t byte);
  void check_silence();
  void ask_for_rest();

  LinePort& port_;
  bool in_order_;
  Show show_;
  std::deque<Typed> queue_;
  Typed current_{0, ""};
  std::size_t typed_ = 0;
  Waiting waiting_ = Waiting::nothing;
  bool held_ = false;      ///< by hand: the queue waits for a resume or a reset
  int reports_asked_ = 0;  ///< by the user; others are ours, and not shown
  Time sent_at_{}, heard_at_{}, asked_at_{};
  std::optional<ConsoleFailure> failure_;
  bool input_ended_ = false;
  bool at_rest_ = false;
  std::optional<Time> rest_asked_at_;
};

}  // namespace lamplock::link
