#include "firmware/motion/line/place.hpp"

#include "shared/work_space.hpp"

namespace lamplock::motion {

LinePlace place_of(const stepper::MotionState& at) {
  constexpr int half = 1 << (place_bits - 1);
  LinePlace place;
  for (std::size_t a = 0; a < max_axes; ++a) {
    place.steps[a] = at.axis[a].step();
    const auto top = static_cast<std::uint32_t>(at.axis[a].position_q64.lo() >> 32);
    const int off = static_cast<int>(((top >> (31 - place_bits)) + 1) >> 1) - half;
    place.off_q8[a] = static_cast<std::int8_t>(off < half ? off : half - 1);
  }
  return place;
}

namespace {

/// A way of any length.
WayParts long_way_between(const LinePlace& from, const LinePlace& to) {
  WayParts way;
  way.bits = place_bits;
  std::uint32_t all = 0;
  for (std::size_t a = 0; a < max_axes; ++a) {
    const std::int64_t steps = std::int64_t{to.steps[a]} - from.steps[a];
    const std::int64_t part = steps * (1 << place_bits) + (to.off_q8[a] - from.off_q8[a]);
    way.parts[a] = part;
    all |= static_cast<std::uint32_t>(static_cast<std::uint64_t>(abs64(part)) >> 32);
  }
  if (all == 0) return way;
  way.bits = 0;
  for (std::int64_t& part : way.parts) {
    const std::int64_t steps = (abs64(part) + (1 << place_bits) - 1) >> place_bits;
    part = part < 0 ? -steps : steps;
  }
  return way;
}

}  // namespace

WayParts way_between(const LinePlace& from, const LinePlace& to) {
  // Nearly all ways are short: their parts have 32 bits with the sign, four times as fast.
  constexpr std::int32_t max_short_steps = (1 << (31 - place_bits)) - 1;
  static_assert(max_position_steps <= 1 << 30, "differences have 32 bits");
  WayParts way;
  way.bits = place_bits;
  for (std::size_t a = 0; a < max_axes; ++a) {
    const std::int32_t steps = to.steps[a] - from.steps[a];
    if (steps >= max_short_steps || steps <= -max_short_steps) return long_way_between(from, to);
    way.parts[a] = steps * (1 << place_bits) + (to.off_q8[a] - from.off_q8[a]);
  }
  return way;
}

}  // namespace lamplock::motion
