// Points in simulated time as scripts count them, and their text.
#pragma once

#include <algorithm>
#include <string>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/script/script.hpp"

namespace lamplock::sim::chip::script {

/// A cycle of clk_sys and its real time. A time that a script gives keeps its picoseconds, so that
/// times that are not whole cycles do not drift.
struct Moment {
  Cycle cycle = 0;
  Picoseconds time = 0;
};

inline Moment moment_of(const TimeWheel& wheel, Cycle cycle) {
  return {cycle, wheel.time_of(cycle)};
}

/// First cycle at or after `span` later.
inline Cycle cycle_after(const TimeWheel& wheel, const Moment& from, Span span) {
  if (span.cycles) return from.cycle + static_cast<Cycle>(span.amount);
  return wheel.cycle_at(from.time + span.amount);
}

/// `span` later; repeated calls do not drift.
inline Moment after(const TimeWheel& wheel, const Moment& from, Span span) {
  const Cycle cycle = cycle_after(wheel, from, span);
  if (span.cycles) return moment_of(wheel, cycle);
  return {cycle, from.time + span.amount};
}

/// Excess over `span` of the time from one moment to another, in cycles or picoseconds; not
/// positive: no excess. Times of cycles are rounded down, hence one picosecond of tolerance.
inline std::int64_t excess(const Moment& from, const Moment& to, Span span) {
  if (span.cycles) return static_cast<std::int64_t>(to.cycle - from.cycle) - span.amount;
  const Picoseconds over = to.time - from.time - span.amount;
  return over == 1 || over == -1 ? 0 : over;
}

/// "10.0072 ms": all digits, in the unit that suits.
std::string time_text(Picoseconds time);
/// The time between two moments, "7.2 us (900 cycles)".
std::string distance_text(const Moment& from, const Moment& to);

}  // namespace lamplock::sim::chip::script
