// Ctrl-C while something runs.
//
// In:  SIGINT, SIGTERM, SIGHUP. Out: how often the user asked; whoever runs the job asks and
// decides. Who: jobs (once: hold, twice: stop) and `sim` (once: end).
#pragma once

namespace lamplock::cli {

/// Counts interrupts as long as it lives; before and after, an interrupt ends the program. One at
/// a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Interrupts since the start or the last forget(); SIGTERM and a terminal that hangs up
  /// count as two: they are never a pause.
  int count() const;
  /// SIGTERM has come since the start.
  bool terminated() const;
  /// The user has gone on: the next interrupt is the first again.
  void forget();
};

}  // namespace lamplock::cli
