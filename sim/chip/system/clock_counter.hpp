// Counts the cycles of a clock of CLOCKS other than clk_sys.
//
// In:  the clock's frequency, each time it changes; real time.
// Out: cycles counted until a time, and the time of a cycle, without drift: the part of a cycle
//      that has passed when the frequency changes, or the clock stops, is kept.
// Who: blocks that run by clk_ref, clk_adc, clk_rtc or an oscillator. The phase of such a clock
//      relative to clk_sys is counted from its first start: the real phase is not defined.
#pragma once

#include <cstdint>

#include "sim/chip/fabric/wide.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim::chip {

/// Cycles since the counter was made; constant while the frequency is 0.
class ClockCounter {
 public:
  /// The clock has another frequency from `now` on.
  void set_frequency(std::uint64_t hz, Picoseconds now) {
    const Wide passed = parts(now);
    base_cycles_ += static_cast<std::uint64_t>(passed / ps_per_s);
    base_parts_ = passed % ps_per_s;
    base_time_ = now;
    hz_ = hz;
  }
  std::uint64_t hz() const { return hz_; }
  /// Whole cycles until a time not before the last change of frequency.
  std::uint64_t cycles(Picoseconds time) const {
    return base_cycles_ + static_cast<std::uint64_t>(parts(time) / ps_per_s);
  }
  /// The number of the first edge at or after a time.
  std::uint64_t next_edge(Picoseconds time) const {
    return base_cycles_ + static_cast<std::uint64_t>((parts(time) + ps_per_s - 1) / ps_per_s);
  }
  /// When a cycle has been counted, rounded up, but not before the last change of frequency; never:
  /// the clock has stopped, or the time is too far away.
  Picoseconds time_of(std::uint64_t cycle) const {
    if (hz_ == 0) return never;
    if (cycle <= base_cycles_) return base_time_;
    constexpr Wide out_of_sight = Wide{1} << 62;  // more than fifty days
    const auto hz = static_cast<Wide>(hz_);
    const Wide left = static_cast<Wide>(cycle - base_cycles_) * ps_per_s - base_parts_;
    const Wide delay = (left + hz - 1) / hz;
    return delay > out_of_sight ? never : base_time_ + static_cast<Picoseconds>(delay);
  }

 private:
  /// Cycles since base_cycles_, times ps_per_s.
  Wide parts(Picoseconds time) const {
    return base_parts_ + static_cast<Wide>(time - base_time_) * static_cast<Wide>(hz_);
  }

  std::uint64_t hz_ = 0;
  std::uint64_t base_cycles_ = 0;
  Wide base_parts_ = 0;  ///< of a cycle that had passed at base_time_, times ps_per_s
  Picoseconds base_time_ = 0;
};

}  // namespace lamplock::sim::chip
