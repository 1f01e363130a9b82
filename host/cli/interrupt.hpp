// Ctrl-C while something runs.
//
// In:  SIGINT, SIGTERM, SIGHUP. Out: the number of requests; the exit status that belongs to the
//      signal. Who: jobs (one: hold, two: stop), `sim` and `jog` (one: end); the main functions.
#pragma once

#include "host/error.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// Before the first Interrupt, SIGINT, SIGTERM and SIGHUP end the program at once, with the status
/// of the signal, the terminal restored and no part of a file left. SIGQUIT and other signals do so
/// at any time. Called once, at the start. A SIGHUP that is ignored then (nohup) is ignored for
/// good; SIGINT is not: also a job in the background must be stopped by it.
void end_at_signals();

/// The exit status of a command that returned `exit`: after an end by a signal, interrupted becomes
/// the status of the signal, as shells report it: 130 SIGINT, 143 SIGTERM, 129 SIGHUP.
int status_of(Exit exit);

/// SIGTERM or SIGHUP has come.
bool is_ended_by_signal();

/// Counts interrupts from its begin to the end of the program; before, an interrupt ends the
/// program. After the object, what it controlled has ended: its report must be written whole, so
/// that a late interrupt has no effect. One at a time.
class Interrupt : public run::Interrupts {
 public:
  Interrupt();
  ~Interrupt() override;
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Interrupts since the start or the last forget(); SIGTERM and a terminal that hangs up
  /// count as two: they are never a pause.
  int count() const override;
  /// SIGTERM has come since the start.
  bool terminated() const;
  /// The user has resumed: the next interrupt is the first again.
  void forget() override;
};

}  // namespace lamplock::cli
