// Signals that wait while a line must not stay as it is.
//
// In:  whatever would end or stop this program (Ctrl-C, Ctrl-Z, a terminal that hangs up, kill).
// Out: the same, behind the scope: lines are at rest by then.
// Who: reset and boot lines (board_lines.cpp), for half a second.
#pragma once

namespace lamplock::gpio {

/// Holds signals back for the whole process as long as it lives, in whichever thread they come;
/// then each that came is raised once, to whoever handled it before. Ignored ones stay so. SIGKILL
/// and SIGSTOP cannot be held back. One at a time.
class LaterSignals {
 public:
  LaterSignals();
  ~LaterSignals();
  LaterSignals(const LaterSignals&) = delete;
  LaterSignals& operator=(const LaterSignals&) = delete;
};

}  // namespace lamplock::gpio
