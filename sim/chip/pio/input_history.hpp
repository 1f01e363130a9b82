// Levels of the pins as the state machines see them: delayed by some flip-flops.
//
// In:  the levels of the inputs, each change with its cycle.
// Out: the levels that an instruction sees; the next change of a pin that is still on its way.
// An instruction that executes in cycle e + 3 sees the level that a pin has in cycle e: two
// flip-flops of the synchroniser (RP2040 datasheet, 3.5.6.3) and one register between the input
// mapping and each state machine, which INPUT_SYNC_BYPASS does not bypass. A machine sees its own
// output after 4 cycles, after 2 with the bypass (raspberrypi/pico-feedback, issue 280).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip::pio {

/// Cycles from a pin to a state machine, and without the synchroniser.
inline constexpr Cycle input_latency = 3;
inline constexpr Cycle bypassed_latency = 1;

/// The last few changes.
class InputHistory {
 public:
  /// The pins have `levels` from cycle `at` on, which never decreases. Returns the bits that
  /// changed.
  std::uint32_t set(std::uint32_t levels, Cycle at) {
    const std::uint32_t changed = levels ^ now_;
    if (changed == 0) return 0;
    if (entries_[last_].at != at) {
      last_ = (last_ + 1) % entries_.size();
      entries_[last_].at = at;
    }
    entries_[last_].levels = levels;
    now_ = levels;
    return changed;
  }
  /// Levels that the state machines see in cycle `cycle`, `latency` after the pins.
  std::uint32_t seen(Cycle cycle, Cycle latency) const {
    if (entries_[last_].at + latency <= cycle) return now_;
    std::size_t i = last_;
    for (std::size_t n = 1; n < entries_.size(); ++n) {
      i = (i + entries_.size() - 1) % entries_.size();
      if (entries_[i].at + latency <= cycle) break;
    }
    return entries_[i].levels;
  }
  /// The first cycle after `cycle` in which the state machines see `pin` (a mask of one bit)
  /// change, as far as the change has happened already; never_cycle: none is on its way.
  Cycle next_change(std::uint32_t pin, Cycle cycle, Cycle latency) const {
    if (entries_[last_].at + latency <= cycle) return never_cycle;
    const std::uint32_t before = seen(cycle, latency) & pin;
    Cycle next = never_cycle;
    std::size_t i = last_;
    for (std::size_t n = 1; n < entries_.size() && entries_[i].at + latency > cycle; ++n) {
      if ((entries_[i].levels & pin) != before) next = entries_[i].at + latency;
      i = (i + entries_.size() - 1) % entries_.size();
    }
    return next;
  }

 private:
  struct Entry {
    Cycle at = 0;
    std::uint32_t levels = 0;
  };
  /// Changes of the last three cycles and of the present one, and the one before them.
  std::array<Entry, 5> entries_{};
  std::size_t last_ = 0;
  std::uint32_t now_ = 0;
};

}  // namespace lamplock::sim::chip::pio
