// Time of the simulated chip: cycles of clk_sys, their real time, and when each part is due.
//
// In:  the next due cycle of each part; the frequency of clk_sys.
// Out: parts run in order of time, at equal times in the order they were added (deterministic).
// Who: the cores advance time, instruction by instruction, and before every access to a register,
//      so that each part is up to date in the cycle in which it is accessed.
//
// A part is run lazily: unobserved changes between two of its events cost nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "sim/world/time.hpp"

namespace lamplock::sim::chip {

/// Cycles of clk_sys since power-up.
using Cycle = std::uint64_t;
inline constexpr Cycle never_cycle = std::numeric_limits<Cycle>::max();

/// A part of the chip that changes by itself as time passes.
class Timed {
 public:
  virtual ~Timed() = default;
  /// Brings the part up to date through cycle `to` (never less than before), and sets on the wheel
  /// when it is due next.
  virtual void run(Cycle to) = 0;
  /// clk_sys has another frequency from now on: times in real units last other numbers of cycles.
  virtual void clock_changed() {}
};

/// The one clock of a chip.
class TimeWheel {
 public:
  using Slot = std::size_t;

  /// Registers a part, not due. It must outlive the wheel's use.
  Slot add(Timed& part) {
    parts_.push_back({&part, never_cycle});
    second_ = no_slot;
    return parts_.size() - 1;
  }
  /// The part is due at `when` (never_cycle: not at all); a time that has passed means now.
  void set(Slot slot, Cycle when) {
    const Cycle old = std::exchange(parts_[slot].due, when);
    if (slot == first_) {
      next_ = when;
      if (second_ == no_slot || before(second_, first_)) promote_second();
    } else if (before(slot, first_)) {
      second_ = std::exchange(first_, slot);
      next_ = when;
    } else if (slot == second_) {
      if (when > old) second_ = no_slot;
    } else if (second_ != no_slot && before(slot, second_)) {
      second_ = slot;
    }
  }

  Cycle now() const { return now_; }
  /// When the first part is due.
  Cycle next() const { return next_; }

  /// For a part that runs and does several things in a row: the next one takes place at `at`,
  /// provided that no other part is due before.
  void move_to(Cycle at) {
    if (now_ < at) now_ = at;
  }

  /// Runs every part that is due up to and including `to`; now() is `to` afterwards. During a run
  /// now() is the time of the event.
  void advance_to(Cycle to) {
    while (next_ <= to) run_next(to);
    if (now_ < to) now_ = to;
  }

  /// Frequency of clk_sys from now on; informs all parts.
  void set_frequency(std::uint64_t hz);
  std::uint64_t frequency() const { return hz_; }
  /// Real time of a cycle not before the last change of frequency, rounded down.
  Picoseconds time_of(Cycle cycle) const;
  Picoseconds time() const { return time_of(now_); }
  /// First cycle at or after a time; of `never`: never_cycle.
  Cycle cycle_at(Picoseconds time) const;

 private:
  struct Part {
    Timed* part;
    Cycle due;
  };
  static constexpr Slot no_slot = std::numeric_limits<Slot>::max();

  /// The part is due before another one: earlier, or added earlier.
  bool before(Slot a, Slot b) const {
    return parts_[a].due != parts_[b].due ? parts_[a].due < parts_[b].due : a < b;
  }
  void run_next(Cycle to);
  void promote_second();

  std::vector<Part> parts_;
  Cycle now_ = 0;
  Cycle next_ = never_cycle;  ///< of first_
  // A part that runs often makes itself due before all others again: with the first two parts known
  // this needs no search.
  Slot first_ = 0;
  Slot second_ = no_slot;         ///< no_slot: any of the others
  std::uint64_t hz_ = 6'500'000;  ///< the ring oscillator, nominally (RP2040 datasheet, 2.17)
  Cycle base_cycle_ = 0;          ///< first cycle at hz_
  Picoseconds base_time_ = 0;
  Picoseconds ps_per_cycle_ = 0;  ///< 0: not a whole number
};

}  // namespace lamplock::sim::chip
