#include "sim/chip/time_wheel.hpp"

#include <algorithm>

namespace lamplock::sim::chip {
namespace {
/// Cycles times picoseconds outgrow 64 bits within a second.
__extension__ using Wide = __int128;
}  // namespace

void TimeWheel::find_next() {
  next_ = never_cycle;
  for (const Part& part : parts_) next_ = std::min(next_, part.due);
}

void TimeWheel::run_next(Cycle to) {
  // The first due part may run on to the time of the next other one, which saves calls.
  std::size_t first = parts_.size();
  Cycle other = never_cycle;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (first == parts_.size() || parts_[i].due < parts_[first].due) {
      if (first != parts_.size()) other = std::min(other, parts_[first].due);
      first = i;
    } else {
      other = std::min(other, parts_[i].due);
    }
  }
  const Cycle due = std::max(now_, parts_[first].due);
  parts_[first].due = never_cycle;
  next_ = other;
  now_ = due;
  parts_[first].part->run(std::max(due, std::min(to, other)));
}

void TimeWheel::set_frequency(std::uint64_t hz) {
  if (hz == hz_) return;
  base_time_ = time_of(now_);
  base_cycle_ = now_;
  hz_ = hz;
  for (const Part& part : parts_) part.part->clock_changed();
}

Picoseconds TimeWheel::time_of(Cycle cycle) const {
  const auto cycles = static_cast<Wide>(cycle) - static_cast<Wide>(base_cycle_);
  return base_time_ + static_cast<Picoseconds>(cycles * ps_per_s / static_cast<Wide>(hz_));
}

Cycle TimeWheel::cycle_at(Picoseconds time) const {
  if (time <= base_time_) return base_cycle_;
  const auto scaled = static_cast<Wide>(time - base_time_) * static_cast<Wide>(hz_);
  return base_cycle_ + static_cast<Cycle>((scaled + ps_per_s - 1) / ps_per_s);
}

}  // namespace lamplock::sim::chip
