// Counts the cycles of a clock of CLOCKS other than clk_sys.
//
// In:  the clock's frequency, each time it changes; real time.
// Out: cycles counted until a time, and the time of a cycle, without drift.
// Who: blocks that run by clk_adc or clk_rtc. The phase of such a clock against clk_sys is taken
//      from when its frequency was set: real phases are anybody's guess.
#pragma once

#include <cstdint>

#include "sim/chip/wide.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim::chip {

/// Cycles since the counter was made; they stand still while the frequency is 0.
class ClockCounter {
 public:
  /// The clock has another frequency from `now` on.
  void set_frequency(std::uint64_t hz, Picoseconds now) {
    base_cycles_ = cycles(now);
    base_time_ = now;
    hz_ = hz;
  }
  std::uint64_t hz() const { return hz_; }
  /// Whole cycles until a time not before the last change of frequency.
  std::uint64_t cycles(Picoseconds time) const {
    return base_cycles_ + static_cast<std::uint64_t>(static_cast<Wide>(time - base_time_) *
                                                     static_cast<Wide>(hz_) / ps_per_s);
  }
  /// The number of the first edge at or after a time.
  std::uint64_t next_edge(Picoseconds time) const {
    const Wide scaled = static_cast<Wide>(time - base_time_) * static_cast<Wide>(hz_);
    return base_cycles_ + static_cast<std::uint64_t>((scaled + ps_per_s - 1) / ps_per_s);
  }
  /// When a cycle not before the last change of frequency has been counted, rounded up; never:
  /// the clock stands still.
  Picoseconds time_of(std::uint64_t cycle) const {
    if (hz_ == 0) return never;
    const auto hz = static_cast<Wide>(hz_);
    const Wide scaled = static_cast<Wide>(cycle - base_cycles_) * ps_per_s + hz - 1;
    return base_time_ + static_cast<Picoseconds>(scaled / hz);
  }

 private:
  std::uint64_t hz_ = 0;
  std::uint64_t base_cycles_ = 0;
  Picoseconds base_time_ = 0;
};

}  // namespace lamplock::sim::chip
