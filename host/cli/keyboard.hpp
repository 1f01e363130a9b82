// Lines that the user types while something runs.
//
// In:  stdin. Out: whole lines, after at most the given wait. Who: the console, for use cases.
//
// Beside a line that is redrawn, a terminal must not echo keys. Then this class reads keys, edits
// the line (Backspace, Ctrl-U), and gives the line that the user has begun to the progress. The key
// `!` is a line at once: a hold does not wait for Enter.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/quiet_terminal.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// Makes lines of keys, as a terminal does that edits lines itself.
class KeyLine {
 public:
  using Clock = std::chrono::steady_clock;

  /// Adds the line to `lines` if this key ends it. Returns false for Ctrl-D at the begin of a line:
  /// the input has ended. `!` is the line "!" and discards what was typed before; an Enter that
  /// follows within a second is the line "!" once more, for an empty line would resume.
  bool take(char key, std::vector<std::string>& lines, Clock::time_point now = Clock::now());
  /// The line so far: printable ASCII; other characters are '?'.
  const std::string& text() const { return text_; }

 private:
  enum class Escape : std::uint8_t { none, begun, inside };
  bool take_escape(char key, Clock::time_point now);

  std::string text_{};
  std::optional<Clock::time_point> held_at_;  ///< the key before was `!`
  Clock::time_point escape_at_{};
  Escape escape_ = Escape::none;
};

/// Reads stdin piece by piece.
class Keyboard : public run::LineInput {
 public:
  enum class Beside { nothing, progress };

  explicit Keyboard(Beside beside);
  /// All lines that have come, up to 64 KB, without their ends. Waits at most this time for the
  /// first one. The rest of an input that has ended without a line end is a line.
  std::vector<std::string> lines(std::chrono::milliseconds wait) override;
  void read_ahead() override { read_waiting(std::chrono::milliseconds(0)); }
  bool ended() const override { return ended_ && typed_.empty(); }
  bool is_typed() const override { return at_terminal(); }

  /// Stdin is a terminal, and this program is in its foreground.
  static bool at_terminal();
  std::string begun() const override { return keys_.text(); }

 private:
  std::vector<std::string> take_lines();
  std::vector<std::string> take_keys();
  void read_waiting(std::chrono::milliseconds wait);
  void read();

  std::optional<QuietTerminal> quiet_;
  bool ended_ = false;
  std::string typed_{};  ///< bytes that are not part of a line yet
  KeyLine keys_;
};

}  // namespace lamplock::cli
