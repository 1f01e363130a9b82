// Defers signals while a line is in a state that must not last.
//
// In:  signals that would end or stop this program (Ctrl-C, Ctrl-Z, a terminal that hangs up,
// kill). Out: the same signals after the scope, when the lines are released. Who: reset and boot
// lines (board_lines.cpp), for half a second.
#pragma once

namespace lamplock::gpio {

/// Defers signals in all threads of the process during its lifetime; then raises each received
/// signal once, for its previous handler. Ignored signals stay ignored. SIGKILL and SIGSTOP cannot
/// be deferred. At most one object may exist.
class LaterSignals {
 public:
  LaterSignals();
  ~LaterSignals();
  LaterSignals(const LaterSignals&) = delete;
  LaterSignals& operator=(const LaterSignals&) = delete;
};

}  // namespace lamplock::gpio
