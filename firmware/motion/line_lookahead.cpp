#include "firmware/motion/line_lookahead.hpp"

namespace lamplock::motion {
namespace {

bool is_before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

}  // namespace

Real nominal_speed(const Line& line, const LineOverride& factor) {
  if (line.rapid) return line.speed.real() * factor.rapid;
  return least(line.speed.real(), line.feed.real() * factor.feed);
}

Real LineLookahead::exit_speed_2(LineRing& ring, const LineOverride& factor) {
  const std::uint32_t joint = ring.begin() + 1;
  if (joint == ring.end()) return {};
  if (stale_ || (is_before(settled_, joint) && end_ != ring.end())) plan(ring, factor);
  return ring.at(joint).entry_2.real();
}

void LineLookahead::plan(LineRing& ring, const LineOverride& factor) {
  std::uint32_t first = ring.begin() + 1;
  if (!stale_ && is_before(first, settled_)) first = settled_ + 1;
  bool found = false;
  Real exit_2, nominal = nominal_speed(ring.at(ring.end() - 1), factor);
  for (std::uint32_t i = ring.end() - 1; !is_before(i, first); --i) {
    Line& line = ring.at(i);
    const Real before = nominal_speed(ring.at(i - 1), factor);
    const Real slower = least(nominal, before);
    const Real brakes_2 = exit_2 + times_power(line.accel.real() * line.length(), 1);
    const LinePacked joint_2(least(line.corner_2.real(), slower * slower));
    const LinePacked all_2(brakes_2);
    const bool settles = !(all_2 < joint_2);
    line.entry_2 = settles ? joint_2 : all_2;
    if (settles && !found) {
      found = true;
      settled_ = i;
    }
    exit_2 = line.entry_2.real();
    nominal = before;
  }
  if (!found && stale_) settled_ = ring.begin();
  stale_ = false;
  end_ = ring.end();
}

}  // namespace lamplock::motion
