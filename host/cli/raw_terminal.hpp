// Keys of a terminal as they are pressed, not line by line.
//
// In:  stdin. Out: its bytes at once, without an echo. Who: `lamplock jog`.
//
// The destructor restores the terminal, also after an exception. Ctrl-C and Ctrl-Z are keys
// meanwhile, for they must not stop the program while it moves a machine. A terminal that hangs up
// ends the input, not the program. A pipe is read in the same way.
#pragma once

#include <termios.h>

#include <string>

#include "host/run/jog_session.hpp"

namespace lamplock::cli {

/// Stdin; one at a time.
class RawTerminal : public run::JogKeys {
 public:
  RawTerminal();
  ~RawTerminal() override;
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// The bytes that have come; never waits.
  std::string read() override;
  /// No further byte will come.
  bool ended() const override { return ended_; }
  /// Restores the terminal; for a signal handler that ends the program.
  static void leave() noexcept;

 private:
  bool ended_ = false;
};

}  // namespace lamplock::cli
