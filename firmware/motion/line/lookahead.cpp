#include "firmware/motion/line/lookahead.hpp"

namespace lamplock::motion {
namespace {

bool is_before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

/// Part of the acceleration that is reserved for brakes where jerk is limited, so that the cost of
/// rounding to pulses does not accumulate until a stop is too late: 2^-6.
constexpr int spare_bits = 6;

/// A pass is made for at least this part of the lines.
constexpr std::uint32_t pass_share = 32;

/// Squared speed from which the line brakes to another.
UFloat brakes_from_2(const Line& line, UFloat exit_2, const LineRise& rise) {
  const UFloat accel = line.accel.real();
  if (rise.none()) return exit_2 + times_power(accel * line.length(), 1);
  const LineRamps ramps{difference(accel, times_power(accel, -spare_bits)), rise};
  const UFloat speed = ramps.highest(square_root(exit_2), line.length());
  return speed * speed;
}

/// nominal_speed(), rounded down.
LinePacked nominal_packed(const Line& line, const LineOverride& factor) {
  if (!factor.plain || line.rapid) return LinePacked(nominal_speed(line, factor));
  return line.speed < line.feed ? line.speed : line.feed;
}

/// Limit of a joint if braking allows at most `brakes_2`: the corner, and the square of the slower
/// of both lines, which is left out if it is far above.
UFloat joint_speed_2(const Line& line, LinePacked slower, UFloat brakes_2) {
  const UFloat corner_2 = line.corner_2.real(), speed = slower.real();
  // Mantissas are 2^31 to 2^32.
  constexpr int mantissa_bits = 31;
  if (brakes_2.exponent() < 2 * speed.exponent() + mantissa_bits) return corner_2;
  return least(corner_2, speed * speed);
}

}  // namespace

UFloat nominal_speed(const Line& line, const LineOverride& factor) {
  if (line.rapid) return line.speed.real() * factor.rapid;
  // An override also slows down a line that its limits keep from the programmed feed.
  const UFloat speed = (line.speed < line.feed ? line.speed : line.feed).real();
  if (factor.plain) return speed;
  return least(line.speed.real(), speed * factor.feed);
}

void LineLookahead::extend(const LineRing& ring, const LineRise& rise) {
  const std::uint32_t last = ring.end() - 1;
  const Line& line = ring.at(last);
  if (is_before(last, end_)) end_ = last;
  const UFloat entry_2 = line.entry_2.real();
  if (line.corner_2 < line.entry_2 || brakes_from_2(line, {}, rise) < entry_2) stale_ = true;
}

UFloat LineLookahead::exit_speed_2(LineRing& ring, const LineOverride& factor,
                                   const LineRise& rise) {
  const std::uint32_t joint = ring.begin() + 1;
  if (joint == ring.end()) return {};
  const std::uint32_t unseen = ring.end() - end_;
  if (stale_ || (is_before(settled_, joint) && unseen != 0 && ring.size() <= unseen * pass_share))
    plan(ring, factor, rise);
  return ring.at(joint).entry_2.real();
}

void LineLookahead::plan(LineRing& ring, const LineOverride& factor, const LineRise& rise) {
  std::uint32_t first = ring.begin() + 1;
  if (!stale_ && is_before(first, settled_)) first = settled_ + 1;
  bool found = false;
  UFloat exit_2;
  LinePacked nominal = nominal_packed(ring.at(ring.end() - 1), factor);
  for (std::uint32_t i = ring.end() - 1; !is_before(i, first); --i) {
    Line& line = ring.at(i);
    const LinePacked before = nominal_packed(ring.at(i - 1), factor);
    const LinePacked slower = before < nominal ? before : nominal;
    nominal = before;
    const UFloat brakes_2 = brakes_from_2(line, exit_2, rise);
    const UFloat joint_2 = joint_speed_2(line, slower, brakes_2);
    const bool settles = !(brakes_2 < joint_2);
    line.entry_2 = LinePacked(settles ? joint_2 : brakes_2);
    if (settles && !found) {
      found = true;
      settled_ = i;
    }
    exit_2 = line.entry_2.real();
  }
  if (!found && stale_) settled_ = ring.begin();
  stale_ = false;
  end_ = ring.end();
}

}  // namespace lamplock::motion
