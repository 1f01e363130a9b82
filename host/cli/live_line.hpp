// The one line at the bottom of a terminal that changes: progress, a position.
//
// In:  a text for a number of columns, as often as the caller wishes; lines that stay. Out: control
//      sequences (ECMA-48, and DECAWM) on the terminal, at most five redraws a second.
// Who: progress.hpp, jog_screen.hpp; the console, which prints other lines above it.
//
// The terminal may become narrower at any time, also than the line that it shows. Then most
// terminals wrap the line, and the others cut it off. So the cursor rests at the first column of
// the line: wherever the rest of the line is now, it lies right of the cursor or below. The line is
// written with automatic wrapping off, for the terminal may shrink between the question for its
// width and the output. The width is read before every redraw, which follows a change as fast as
// SIGWINCH would, at the same rate of redraws, and interrupts no other call.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace lamplock::cli {

/// Shown from its first redraw until it is destroyed. Several may exist; only the last one made is
/// shown.
class LiveLine {
 public:
  using Clock = std::chrono::steady_clock;
  /// The text for at most so many columns, one column for each byte.
  using Text = std::function<std::string(std::size_t columns)>;
  static constexpr std::chrono::milliseconds redraw_interval{200};

  /// `out`: a terminal.
  LiveLine(std::FILE* out, Text text, std::function<Clock::time_point()> now = Clock::now);
  /// Removes the line, and prints the lines that still wait.
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  /// A stream on which such a line can be shown: a terminal, in its foreground, that is not dumb.
  static bool can_show(std::FILE* out);

  /// Redraws the line if it is time.
  void refresh();
  /// Prints a line, without its end, above this one with the next redraw, wrapped at words.
  void note(const std::string& line);
  /// Shows the present text and leaves it on the terminal.
  void keep();

  /// Prints text that ends with a line end on a stream: above the line that is shown, if the stream
  /// is a terminal too.
  static void print(std::FILE* out, const std::string& text);

 private:
  bool is_due() const;
  void draw();
  void clear() noexcept;
  std::string take_waiting();

  std::FILE* out_;
  Text text_;
  std::function<Clock::time_point()> now_;
  Clock::time_point drawn_at_;
  std::string waiting_;  ///< lines to print above
  bool drawn_ = false;
  LiveLine* below_;  ///< the one that was shown before
};

/// Columns of a terminal, 80 if it does not report them.
std::size_t columns_of(std::FILE* terminal);

}  // namespace lamplock::cli
