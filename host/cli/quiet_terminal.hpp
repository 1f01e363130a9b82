// Keys that the user types do not appear on the terminal while a line is redrawn there.
//
// In:  the terminal of stdin. Out: its modes: no echo; on request no lines either, so that the
//      program reads each key at once. Ctrl-C and Ctrl-Z remain signals.
// Who: progress on a terminal, the keyboard of a job; handlers of signals that end the program.
//
// An echoed Enter would move the cursor, and the next redraw would leave a copy of the line.
#pragma once

namespace lamplock::cli {

/// The modes hold as long as one object exists; the last one restores the terminal. Does nothing
/// without a terminal and in the background.
class QuietTerminal {
 public:
  enum class Reads { lines, keys };

  explicit QuietTerminal(Reads reads);
  ~QuietTerminal();
  QuietTerminal(const QuietTerminal&) = delete;
  QuietTerminal& operator=(const QuietTerminal&) = delete;

  /// The program reads keys now, not lines.
  static bool reads_keys();
  /// Sets the modes again if the shell has changed them while the program was stopped (Ctrl-Z).
  static void refresh();
  /// Restores the terminal and clears the line that is redrawn; for a signal handler that ends the
  /// program.
  static void leave() noexcept;

  /// `descriptor` is a terminal, and this program is not in its background: reading would stop the
  /// program there, and its output would disturb another program.
  static bool in_foreground(int descriptor);

 private:
  static void restore() noexcept;

  Reads reads_;
};

}  // namespace lamplock::cli
