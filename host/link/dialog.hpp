// Questions to a board, one at a time, each with its answer.
//
// In:  a line. Out: the lines that came back, and how the answer ended.
// Who: settings; senders and the console, before they begin. Waits, by the transport's clock.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::link {

/// How patient it is.
struct Patience {
  std::chrono::microseconds again{1'000'000};    ///< until `$I` is sent again
  std::chrono::microseconds give_up{4'000'000};  ///< without an answer
};

/// A board that has answered.
struct Greeting {
  BoardIdentity identity;
  BoardStatus status;
  /// Bytes that may be under way: what `$I` says, or less if the idle board has less.
  std::size_t window_bytes = 0;
};

/// Asks a board what it is (`$I`) and how it is (`?`). What it says meanwhile goes to nobody.
/// Throws Error(no_device) if no version line comes.
Greeting greet(LinePort& port, const Patience& patience = {});

/// What came back for a line.
struct Answer {
  std::vector<std::string> lines;
  int error = 0;  ///< 0 = ok
};

/// Sends a line and waits for its answer; status reports and messages in between are left out.
/// Throws Error(no_device) if none comes, or the connection breaks.
Answer ask(LinePort& port, const std::string& line, const Patience& patience = {});

/// Throws Error(no_device) if the transport is known to be cut.
void expect_connected(LinePort& port);

}  // namespace lamplock::link
