// Ctrl-C while something runs.
//
// In:  SIGINT, SIGTERM, SIGHUP. Out: the number of requests. Who: jobs (one: hold, two: stop),
// `sim` and `jog` (one: end).
#pragma once

#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// Counts interrupts as long as it lives; before and after, an interrupt ends the program. One at
/// a time.
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
