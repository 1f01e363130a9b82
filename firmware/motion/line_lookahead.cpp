#include "firmware/motion/line_lookahead.hpp"

namespace lamplock::motion {
namespace {

bool is_before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

/// Part of the acceleration that is left to brakes where jerk is limited, so that what rounding to
/// pulses costs does not add up until a stop comes too late: 2^-6.
constexpr int spare_bits = 6;

/// Squared speed from which the line brakes to another.
Real brakes_from_2(const Line& line, Real exit_2, const LineRise& rise) {
  const Real accel = line.accel.real();
  if (rise.none()) return exit_2 + times_power(accel * line.length(), 1);
  const LineRamps ramps{difference(accel, times_power(accel, -spare_bits)), rise};
  const Real speed = ramps.highest(square_root(exit_2), line.length());
  return speed * speed;
}

}  // namespace

Real nominal_speed(const Line& line, const LineOverride& factor) {
  if (line.rapid) return line.speed.real() * factor.rapid;
  return least(line.speed.real(), line.feed.real() * factor.feed);
}

Real LineLookahead::exit_speed_2(LineRing& ring, const LineOverride& factor, const LineRise& rise) {
  const std::uint32_t joint = ring.begin() + 1;
  if (joint == ring.end()) return {};
  if (stale_ || (is_before(settled_, joint) && end_ != ring.end())) plan(ring, factor, rise);
  return ring.at(joint).entry_2.real();
}

void LineLookahead::plan(LineRing& ring, const LineOverride& factor, const LineRise& rise) {
  std::uint32_t first = ring.begin() + 1;
  if (!stale_ && is_before(first, settled_)) first = settled_ + 1;
  bool found = false;
  Real exit_2, nominal = nominal_speed(ring.at(ring.end() - 1), factor);
  for (std::uint32_t i = ring.end() - 1; !is_before(i, first); --i) {
    Line& line = ring.at(i);
    const Real before = nominal_speed(ring.at(i - 1), factor);
    const Real slower = least(nominal, before);
    const Real brakes_2 = brakes_from_2(line, exit_2, rise);
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
