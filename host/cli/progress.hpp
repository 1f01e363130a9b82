// Progress on stderr: a line that changes on a terminal, otherwise a line every ten per cent, at
// most two a second.
//
// In:  how much is done, as often as the caller wishes. Out: text. Who: the console, for use cases.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <optional>
#include <string>

#include "host/cli/live_line.hpp"
#include "host/cli/quiet_terminal.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// ", 3 min 12 s left, ends 15:42": the end, by the clock of this place, of what takes a minute and
/// more.
std::string left_text(double seconds, std::time_t now);

/// What a line of progress shows.
struct ProgressFields {
  std::string title;
  std::size_t done = 0, total = 0;
  std::string state, speed;  ///< "held", "speed 150 %"; empty: not shown
  std::string left, ends;    ///< "3 min 12 s left", "ends 15:42"; empty: not known
  std::string typed;         ///< by the user, before Enter
};

/// The line for at most so many columns. If they are few, the bar becomes shorter, then fields are
/// left out: the bar first, the percentage last.
std::string progress_line(const ProgressFields& fields, std::size_t columns);

/// Progress of one thing.
class ProgressBar : public run::Progress {
 public:
  /// `title` names the activity; `first` were done before.
  ProgressBar(std::string title, std::size_t total, std::size_t first = 0);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::size_t done) override;
  void set_left(std::optional<double> seconds) override { left_s_ = seconds; }
  void set_state(const run::ProgressState& state) override;
  /// Prints a line that stays, above the bar.
  void note(const std::string& line) override;

 private:
  using Clock = std::chrono::steady_clock;
  bool is_working() const { return state_.word.empty(); }
  std::optional<double> left_s(std::size_t done) const;
  ProgressFields fields() const;

  std::string title_;
  std::size_t total_, first_, done_;
  Clock::time_point working_since_ = Clock::now();  ///< or waiting since then
  Clock::duration worked_{0};                       ///< before, since the pace began at first_
  Clock::time_point printed_at_ = working_since_;
  std::size_t next_line_percent_;
  std::optional<double> left_s_;
  run::ProgressState state_;
  std::optional<QuietTerminal> quiet_;
  std::optional<LiveLine> line_;  ///< on a terminal
};

}  // namespace lamplock::cli
