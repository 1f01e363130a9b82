#include "sim/chip/fabric/time_wheel.hpp"

#include <algorithm>

#include "sim/chip/fabric/wide.hpp"

namespace lamplock::sim::chip {

/// The first part is no longer due first.
void TimeWheel::promote_second() {
  if (second_ == no_slot) {
    second_ = 0;
    for (Slot i = 1; i < parts_.size(); ++i)
      if (before(i, second_)) second_ = i;
  }
  first_ = std::exchange(second_, no_slot);
  next_ = parts_[first_].due;
}

void TimeWheel::run_next(Cycle to) {
  Part& part = parts_[first_];
  now_ = std::max(now_, std::exchange(part.due, never_cycle));
  promote_second();
  // It may run up to the time of the next other part, which saves calls.
  part.part->run(std::max(now_, std::min(to, next_)));
}

void TimeWheel::set_frequency(std::uint64_t hz) {
  if (hz == hz_) return;
  base_time_ = time_of(now_);
  base_cycle_ = now_;
  hz_ = hz;
  ps_per_cycle_ =
      ps_per_s % static_cast<Picoseconds>(hz) == 0 ? ps_per_s / static_cast<Picoseconds>(hz) : 0;
  for (const Part& part : parts_) part.part->clock_changed();
}

Picoseconds TimeWheel::time_of(Cycle cycle) const {
  // Each recorded edge calls this, and a division of 128 bits takes as long as an edge.
  if (ps_per_cycle_ != 0)
    return base_time_ + static_cast<Picoseconds>(cycle - base_cycle_) * ps_per_cycle_;
  const auto cycles = static_cast<Wide>(cycle) - static_cast<Wide>(base_cycle_);
  return base_time_ + static_cast<Picoseconds>(cycles * ps_per_s / static_cast<Wide>(hz_));
}

Cycle TimeWheel::cycle_at(Picoseconds time) const {
  if (time <= base_time_) return base_cycle_;
  if (time == never) return never_cycle;
  const auto scaled = static_cast<Wide>(time - base_time_) * static_cast<Wide>(hz_);
  return base_cycle_ + static_cast<Cycle>((scaled + ps_per_s - 1) / ps_per_s);
}

}  // namespace lamplock::sim::chip
