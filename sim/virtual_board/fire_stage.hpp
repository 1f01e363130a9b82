// The fire stage: models what the PIO of a real board does between LAMP SYNC and Q-switch.
//
// In:  edges of LAMP SYNC, the level of the arm bit, at most one token.
// Out: Q-switch pulses; one verdict per accepted edge.
// It works like the hardware: a rising edge that stays high for the runt filter is accepted; one
// decision is made a fixed number of clocks after the edge: armed or not, with or without a token;
// a shot starts exactly `delay` after the edge. During a pulse the stage sees no edges. A shot
// counts once its pulse has begun: an e-stop between decision and pulse cancels it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/machine/controller.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

inline constexpr Picoseconds ps_per_clock = 1'000'000'000'000 / lamplock::clock_hz;

/// Edge and decision.
struct Verdict {
  std::uint64_t edge_clock = 0;
  bool fired = false;
};

/// One fire stage.
class FireStage {
 public:
  void configure(const machine::FireTiming& timing) { timing_ = timing; }

  /// LAMP SYNC changed.
  void sync_changed(bool level, Picoseconds at) {
    if (!level) {
      // The filter requires the level to last: a shorter one is a runt.
      if (decision_ != never && at - edge_ <= filter) decision_ = never;
      return;
    }
    if (at < busy_until_ || decision_ != never) return;
    edge_ = at;
    const Picoseconds clock = at / ps_per_clock;
    decision_ = (clock + machine::fire_decision_clocks) * ps_per_clock;
  }

  /// Time of its next action; `never` if none.
  Picoseconds next_event() const { return std::min({decision_, rise_, fall_}); }
  bool decision_due(Picoseconds now) const { return decision_ <= now; }

  /// Makes a due decision.
  Verdict decide(bool armed, bool token) {
    const Picoseconds clock = edge_ / ps_per_clock;
    decision_ = never;
    const Verdict verdict{static_cast<std::uint64_t>(clock), armed && token};
    if (verdict.fired) {
      rise_ = (clock + timing_.delay_clocks) * ps_per_clock;
      fall_ = rise_ + timing_.width_clocks * ps_per_clock;
      busy_until_ = fall_;
    }
    return verdict;
  }

  /// Drives the Q-switch up to `now`; true if a pulse began.
  bool drive(PinBus& bus, Picoseconds now) {
    const bool begins = rise_ <= now;
    if (begins) {
      bus.set(Pin::q_switch, true, rise_);
      rise_ = never;
    }
    if (fall_ <= now) {
      bus.set(Pin::q_switch, false, fall_);
      fall_ = never;
    }
    return begins;
  }

  /// Withdraws firing: a pulse that has not started does not start, one in progress ends.
  void disarm(PinBus& bus, Picoseconds now) {
    rise_ = never;
    if (fall_ == never) return;
    bus.set(Pin::q_switch, false, now);
    fall_ = never;
    busy_until_ = now;
  }

 private:
  static constexpr Picoseconds filter = lamp::min_sync_clocks * ps_per_clock;
  machine::FireTiming timing_;
  Picoseconds edge_ = 0;
  Picoseconds decision_ = never;
  Picoseconds rise_ = never, fall_ = never;
  Picoseconds busy_until_ = 0;
};

}  // namespace lamplock::sim
