// Time of the simulated chip: cycles of clk_sys, their place in real time, and who is due when.
//
// In:  each part says when it wants to run next; the frequency of clk_sys.
// Out: parts run in order of time, equal times in the order they were added (deterministic).
// Who: the cores move time on, instruction by instruction, and before every access to a register,
//      so that each part is up to date to the cycle in which it is looked at.
//
// A part is run lazily: what happens to it between two of its own events and that nobody looks at
// costs nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim::chip {

/// Cycles of clk_sys since power-up.
using Cycle = std::uint64_t;
inline constexpr Cycle never_cycle = std::numeric_limits<Cycle>::max();

/// A part of the chip that does something by itself as time passes.
class Timed {
 public:
  virtual ~Timed() = default;
  /// Brings the part up to date through cycle `to` (never less than before), and tells the wheel
  /// when it is due next.
  virtual void run(Cycle to) = 0;
  /// clk_sys has another frequency from now on: times in real units mean other cycles.
  virtual void clock_changed() {}
};

/// The one clock of a chip.
class TimeWheel {
 public:
  using Slot = std::size_t;

  /// Registers a part, not due. It must outlive the wheel's use.
  Slot add(Timed& part) {
    parts_.push_back({&part, never_cycle});
    return parts_.size() - 1;
  }
  /// The part is due at `when` (never_cycle: not at all); a time that has passed means now.
  void set(Slot slot, Cycle when) {
    const Cycle old = parts_[slot].due;
    parts_[slot].due = when;
    if (when < next_)
      next_ = when;
    else if (old == next_)
      find_next();
  }

  Cycle now() const { return now_; }
  /// When the first part is due.
  Cycle next() const { return next_; }

  /// Runs every part that is due up to and including `to`; now() is `to` afterwards. During a run
  /// now() is the time of the event.
  void advance_to(Cycle to) {
    while (next_ <= to) run_next(to);
    if (now_ < to) now_ = to;
  }

  /// Frequency of clk_sys from now on; tells all parts.
  void set_frequency(std::uint64_t hz);
  std::uint64_t frequency() const { return hz_; }
  /// Real time of a cycle not before the last change of frequency, rounded down.
  Picoseconds time_of(Cycle cycle) const;
  /// First cycle at or after a time.
  Cycle cycle_at(Picoseconds time) const;

 private:
  struct Part {
    Timed* part;
    Cycle due;
  };
  void run_next(Cycle to);
  void find_next();

  std::vector<Part> parts_;
  Cycle now_ = 0;
  Cycle next_ = never_cycle;
  std::uint64_t hz_ = 6'500'000;  ///< the ring oscillator, nominally (RP2040 datasheet, 2.17)
  Cycle base_cycle_ = 0;          ///< where hz_ began to hold
  Picoseconds base_time_ = 0;
};

}  // namespace lamplock::sim::chip
