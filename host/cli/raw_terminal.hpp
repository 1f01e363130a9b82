// Keys of a terminal as they are pressed, not line by line.
//
// In:  stdin. Out: its bytes at once, without an echo. Who: `lamplock jog`.
//
// The terminal is as it was before when this ends, by an exception too. Ctrl-C and Ctrl-Z are keys
// meanwhile: nobody shall stop this program while it moves a machine. A terminal that hangs up is
// an end of the input, not of the program. A pipe is read in the same way.
#pragma once

#include <termios.h>

#include <optional>
#include <string>

namespace lamplock::cli {

/// Stdin; one at a time.
class RawTerminal {
 public:
  RawTerminal();
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// What has come; never waits.
  std::string read();
  /// Nothing will come any more.
  bool ended() const { return ended_; }

 private:
  std::optional<termios> before_;
  bool ended_ = false;
};

}  // namespace lamplock::cli
