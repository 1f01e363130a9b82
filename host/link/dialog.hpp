// Questions to a board, one at a time, each with its answer.
//
// In:  a line. Out: the lines of the answer, and its ok or error.
// Who: settings; senders and the console, before they begin. Waits, by the transport's clock.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::link {

/// Time-outs.
struct Patience {
  std::chrono::microseconds again{1'000'000};    ///< until `$I` is sent again
  std::chrono::microseconds timeout{4'000'000};  ///< without an answer
};

/// A board that has answered.
struct Greeting {
  BoardIdentity identity;
  BoardStatus status;
  /// Bytes that may be under way: as `$I` reports, or less if the idle board has less free.
  std::size_t window_bytes = 0;
};

/// Asks a board for its version (`$I`) and its status (`?`); other lines from it are ignored.
/// Throws Error(no_device) if it sends no version line or no status.
Greeting greet(LinePort& port, const Patience& patience = {});

/// The answer to a line.
struct Answer {
  std::vector<std::string> lines;
  int error = 0;  ///< 0 = ok
};

/// Sends a line and waits for its answer; status reports and messages in between are ignored.
/// Throws Error(no_device) if no answer arrives, or the connection breaks.
Answer ask(LinePort& port, const std::string& line, const Patience& patience = {});

/// Ends an alarm, or the lock after power-up. Throws as greet() and ask().
void unlock(LinePort& port);

/// Throws Error(no_device) if the transport is known to be cut.
void expect_connected(LinePort& port);

}  // namespace lamplock::link
