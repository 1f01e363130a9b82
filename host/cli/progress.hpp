// Progress on stderr: a bar with the time left on a terminal, otherwise a line every ten per cent,
// at most two a second.
//
// In:  how much is done, as often as the caller wishes. Out: text. Who: the console, for use cases.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <optional>
#include <string>

#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// ", 3:12 left, ends 15:42": the end, by the clock of this place, of what takes a minute and more.
std::string left_text(double seconds, std::time_t now);

/// Progress of one thing.
class ProgressBar : public run::Progress {
 public:
  /// `title` names the activity; `first` were done before.
  ProgressBar(std::string title, std::size_t total, std::size_t first = 0);
  /// Removes the bar.
  ~ProgressBar() override;
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::size_t done) override;
  void set_left(std::optional<double> seconds) override { left_s_ = seconds; }
  /// Prints a line that stays, above the bar.
  void note(const std::string& line) override;
  void pause_ended(std::chrono::steady_clock::duration pause) override { start_ += pause; }

 private:
  using Clock = std::chrono::steady_clock;
  std::string left(std::size_t done) const;
  void draw(std::size_t done);
  void clear();

  std::string title_;
  std::size_t total_, first_;
  bool terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_at_ = start_;
  std::size_t next_line_percent_;
  bool drawn_ = false;
  std::optional<double> left_s_;
};

}  // namespace lamplock::cli
