// A console for a board: typed lines, and words for real-time bytes.
//
// In:  typed lines; lines from the board. Out: lines to the board, each sent after the answer to
//      the one before; all lines from the board, to be shown.
// Who: `lamplock console`. It uses a port of the caller and no terminal, so that tests can use it.
//
// Interactive: real-time words are sent at once, before queued lines. A hold also stops the queue
// until a resume, a jog cancel discards the jogs in it, and a reset discards all of it. A line that
// has `!` in it, or ends in a word that stops the machine, stops it; the rest of it is discarded.
// In order, for scripts: words wait in the queue like lines, and the first error or alarm ends the
// conversation; but while the machine pauses within a line, the word after this line is sent, or
// the machine would wait for ever. A pause in the last line ends the conversation.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::link {

/// The byte of a real-time word: `?` `!` `~`, or `:hold`, `:feed +10` and so on; empty for other
/// text. Throws Error(bad_input) for an unknown word that begins with a colon.
std::optional<std::uint8_t> realtime_word(std::string_view typed);
/// All words, for a help text.
std::string realtime_words();

/// The error or alarm that ended a conversation, or the hold at its end.
struct ConsoleFailure {
  std::size_t line = 0;  ///< number of the typed line, from 1
  std::string text;      ///< error or alarm of the board, with its meaning
  const char* remedy = "";
};

/// One conversation; the port must outlive it.
class LineConsole {
 public:
  using Show = std::function<void(const std::string&)>;
  LineConsole(LinePort& port, bool in_order, Show show)
      : port_(port), in_order_(in_order), show_(std::move(show)) {}

  /// Takes a typed line. Throws Error(bad_input) as realtime_word() and line_to_send(), and for a
  /// real-time word without its colon.
  void type(const std::string& line);
  /// One round: reads, shows, sends, waits a little. Throws Error(no_device) if the board is
  /// disconnected or does not answer.
  void step();
  /// Typed lines that have not been sent.
  std::size_t queued() const { return queue_.size(); }
  /// Everything typed has been sent and answered.
  bool done() const;
  /// No more lines follow: step() asks for the status until the machine is at rest. A board whose
  /// port is closed during motion goes into feed hold.
  void end_input() { input_ended_ = true; }
  /// The board has reported that it is at rest, or has not answered.
  bool at_rest() const { return at_rest_; }
  /// The first error or alarm; with in_order no line is sent after it.
  const std::optional<ConsoleFailure>& failure() const { return failure_; }

 private:
  using Time = std::chrono::microseconds;
  enum class Waiting : std::uint8_t { nothing, answer, status, banner };
  struct Typed {
    std::size_t number;
    std::string text;
  };

  void take(const std::string& line);
  void fail(const std::string& text, const char* remedy = "later lines were not sent");
  void fail_held(const BoardStatus& status);
  void send_next();
  void send_word_after_pause();
  void note_pause(const BoardStatus& status);
  void send_byte(std::uint8_t byte, const std::string& discarded = "");
  bool stop_by(std::string_view line);
  void refuse_word(const std::string& line, const std::string& where) const;
  void hold_queue(std::uint8_t byte);
  void show_sent(std::uint8_t byte, const std::string& discarded);
  void check_silence();
  void ask_for_rest();

  LinePort& port_;
  bool in_order_;
  Show show_;
  std::deque<Typed> queue_;
  Typed current_{0, ""};
  std::size_t noted_line_ = 0;  ///< the line whose pause was shown
  std::size_t typed_ = 0;
  Waiting waiting_ = Waiting::nothing;
  /// In order: the machine may be held at the end. True at the start, after a hold and after a
  /// pause; false after any other line of a program, a resume or a reset.
  bool hold_is_expected_ = true;
  bool held_ = false;      ///< interactive: the queue waits for a resume or a reset
  int reports_asked_ = 0;  ///< by the user; other reports are not shown
  Time sent_at_{}, heard_at_{}, asked_at_{};
  std::optional<ConsoleFailure> failure_;
  bool input_ended_ = false;
  bool at_rest_ = false;
  std::optional<Time> rest_asked_at_;
};

}  // namespace lamplock::link
