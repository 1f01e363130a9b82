// Levels of the pins as the PIO blocks see them: two flip-flops behind the pads.
//
// In:  the levels of the inputs, each change with its cycle.
// Out: the levels at a cycle, which lies at most `input_flip_flops` back; the next change of a pin
//      that is still on its way through the flip-flops.
// A level that a pin has in cycle e is what an instruction sees that executes in cycle e + 2
// (RP2040 datasheet, 3.5.6.3), in cycle e with INPUT_SYNC_BYPASS.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/chip/time_wheel.hpp"

namespace lamplock::sim::chip::pio {

/// Stages of the synchroniser between a pin and a state machine (3.5.6.3).
inline constexpr Cycle input_flip_flops = 2;

/// The last few changes.
class InputHistory {
 public:
  /// The pins have `levels` from cycle `at` on. Cycles never go back. Returns the bits that
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
  std::uint32_t now() const { return now_; }
  /// What the state machines see in cycle `cycle` behind both flip-flops.
  std::uint32_t synchronised(Cycle cycle) const {
    if (entries_[last_].at + input_flip_flops <= cycle) return now_;
    std::size_t i = last_;
    for (std::size_t n = 1; n < entries_.size(); ++n) {
      i = (i + entries_.size() - 1) % entries_.size();
      if (entries_[i].at + input_flip_flops <= cycle) break;
    }
    return entries_[i].levels;
  }
  /// The first cycle after `cycle` in which the state machines see `pin` (a mask of one bit)
  /// change, as far as the change has happened already; never_cycle: none is on its way.
  Cycle next_change(std::uint32_t pin, Cycle cycle) const {
    if (entries_[last_].at + input_flip_flops <= cycle) return never_cycle;
    const std::uint32_t seen = synchronised(cycle) & pin;
    Cycle next = never_cycle;
    std::size_t i = last_;
    for (std::size_t n = 1; n < entries_.size() && entries_[i].at + input_flip_flops > cycle; ++n) {
      if ((entries_[i].levels & pin) != seen) next = entries_[i].at + input_flip_flops;
      i = (i + entries_.size() - 1) % entries_.size();
    }
    return next;
  }

 private:
  struct Entry {
    Cycle at = 0;
    std::uint32_t levels = 0;
  };
  /// Changes of the last two cycles and of the present one, and the one before them.
  std::array<Entry, 4> entries_{};
  std::size_t last_ = 0;
  std::uint32_t now_ = 0;
};

}  // namespace lamplock::sim::chip::pio
