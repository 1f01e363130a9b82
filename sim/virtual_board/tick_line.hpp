// The tick line: the start time of each tick.
//
// In:  spans of ticks with their length in clocks, from the beat clock.
// Out: time of a tick, tick at a time. The clocks of a span are spread evenly over its ticks, so
//      that their sum is exact, as in the hardware.
#pragma once

#include <cstdint>
#include <deque>

#include "firmware/lamp/beat_clock.hpp"
#include "sim/virtual_board/fire_stage.hpp"

namespace lamplock::sim {

/// A queue of spans without gaps.
class TickLine {
 public:
  void push(const lamp::TickSpan& span) { spans_.push_back(span); }
  /// Drops spans that end at or before `tick`.
  void drop_before(std::uint64_t tick) {
    while (spans_.size() > 1 && spans_.front().first_tick + spans_.front().ticks <= tick)
      spans_.pop_front();
  }

  /// First tick without a time.
  std::uint64_t end_tick() const {
    return spans_.empty() ? 0 : spans_.back().first_tick + spans_.back().ticks;
  }
  Picoseconds end_time() const {
    if (spans_.empty()) return 0;
    return static_cast<Picoseconds>(spans_.back().first_clock + spans_.back().clocks) *
           ps_per_clock;
  }

  /// The span a tick lies in; the tick must be known and not dropped.
  const lamp::TickSpan& span_of(std::uint64_t tick) const {
    for (const lamp::TickSpan& span : spans_)
      if (tick < span.first_tick + span.ticks) return span;
    return spans_.back();
  }
  static Picoseconds time_in(const lamp::TickSpan& span, std::uint64_t tick) {
    const std::uint64_t clock =
        span.first_clock + (tick - span.first_tick) * span.clocks / span.ticks;
    return static_cast<Picoseconds>(clock) * ps_per_clock;
  }
  /// Start of a tick; end_tick() is allowed.
  Picoseconds time_of(std::uint64_t tick) const {
    return tick >= end_tick() ? end_time() : time_in(span_of(tick), tick);
  }
  /// First tick that starts at or after `at`.
  std::uint64_t first_tick_from(Picoseconds at) const {
    for (const lamp::TickSpan& span : spans_) {
      const auto end = static_cast<Picoseconds>(span.first_clock + span.clocks) * ps_per_clock;
      if (at >= end) continue;
      const auto start = static_cast<Picoseconds>(span.first_clock) * ps_per_clock;
      if (at <= start) return span.first_tick;
      const auto clock = static_cast<std::uint64_t>((at - start + ps_per_clock - 1) / ps_per_clock);
      return span.first_tick + (clock * span.ticks + span.clocks - 1) / span.clocks;
    }
    return end_tick();
  }

 private:
  std::deque<lamp::TickSpan> spans_;
};

}  // namespace lamplock::sim
