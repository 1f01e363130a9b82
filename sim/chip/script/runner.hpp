// Runs a script on a chip: sets pins at their cycle, sends texts, compares pads and ports with the
// expectations.
//
// In:  a script, a chip, its serial ports. Out: passed, failed (where, what, when), or not done
//      yet.
// Who: the owner of the chip; the runner is a part of its wheel and acts by itself.
//
// The script has its own time: that of its last step or of the edge that ended a wait. It is exact
// even where the runner finds an edge later (check.hpp), so that `after` counts from the edge
// itself; an action whose time has passed then takes place at once.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/chip/script/check.hpp"

namespace lamplock::sim::chip::script {

/// Why a script has not passed.
struct Failure {
  int line = 0;
  std::string expected, seen;
  Picoseconds at = 0;
};

/// One script on one chip; must live as long as the chip runs.
class Runner final : private Timed {
 public:
  /// Must be made before the chip runs; begins at time 0, or now.
  Runner(Chip& chip, SerialPorts& ports, Script script);
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// True if passed or failed; nothing more happens.
  bool done() const { return done_; }
  const std::optional<Failure>& failure() const { return failure_; }
  /// The present step of a script that is not done, as a failure at the time `now`.
  Failure not_complete(Picoseconds now) const;
  /// The script allows faults of this kind.
  bool allows(FaultKind kind) const;

 private:
  /// A check and the step it belongs to.
  struct Open {
    std::size_t step = 0;
    std::unique_ptr<Check> check;
  };
  /// Next change of the script's time.
  struct Way {
    Moment from;
    Span span;
  };
  /// Pulses on one pin.
  struct Train {
    Pulse pulse;
    Moment begin;         ///< of the pulse in progress or the next one
    bool inside = false;  ///< the pulse has begun and not ended
    std::uint64_t sent = 0;
  };
  struct Actor;

  void run(Cycle to) override;
  void clock_changed() override { plan(); }
  void plan();
  Cycle due(Cycle now) const;
  bool advance(Cycle now);
  bool arrive(Cycle now);
  bool finish_sending(Cycle now);
  void take_step(Cycle now);
  void act_now(Cycle now);
  bool poll(Open& open, Cycle now);
  void poll_beside(Cycle now);
  void drive_trains(Cycle now);
  Cycle due(const Train& train) const;
  void fail(std::size_t step, std::string seen, Picoseconds at);
  void forget();

  Chip& chip_;
  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  SerialPorts& ports_;
  Script script_;
  PadLog pads_;
  std::vector<PinEdge> causes_;  ///< of all reactions in the script
  Moment time_;                  ///< the script's own
  std::size_t next_ = 0;         ///< step
  // What the script waits for, one at most:
  std::optional<Way> way_;
  std::optional<Port> sending_;
  Open open_;

  std::vector<Open> beside_;  ///< expectations that it does not wait for
  std::array<std::optional<Train>, gpio_count> trains_{};
  bool done_ = false;
  std::optional<Failure> failure_;
};

}  // namespace lamplock::sim::chip::script
