#include "firmware/motion/way.hpp"

namespace lamplock::motion {
namespace {

/// Rounding of reach() is inwards; a guide must not cut off what is just possible.
constexpr std::int64_t guide_slack_q32 = 64;

/// Cuts an interval to another one; false if nothing is left.
bool cut(SpeedInterval& side, const SpeedInterval& to) {
  if (side.lo_q32 < to.lo_q32) side.lo_q32 = to.lo_q32;
  if (side.hi_q32 > to.hi_q32) side.hi_q32 = to.hi_q32;
  return side.lo_q32 <= side.hi_q32;
}

void widen(SpeedInterval& hull, const SpeedInterval& by) {
  if (by.lo_q32 < hull.lo_q32) hull.lo_q32 = by.lo_q32;
  if (by.hi_q32 > hull.hi_q32) hull.hi_q32 = by.hi_q32;
}

/// Displacement from rest to rest in so many beats: half of them to the top speed, at most to the
/// limit.
std::int64_t most_from_rest_q32(std::int64_t beats, std::int64_t limit) {
  const std::int64_t half_q32 = beats << 31;
  if (half_q32 <= limit) return (beats * beats) << 30;
  const auto ramp = mul_q32(limit, limit);
  return times_short(limit, static_cast<std::uint32_t>(beats)) - ramp;
}

/// Hull of one axis at the start of a way: both bounds are reached with the fewest and with the
/// most beats, since each falls and then rises, or rises and then falls, with the time.
SpeedInterval hull_before(const Window& window, const Way& way, int a) {
  const std::int64_t q = way.displacement_q32[index(a)], limit = window.speed_limit_q32(a);
  SpeedInterval hull, side;
  std::int32_t first = way.fixed_beats != 0 ? way.fixed_beats : way.first_beats;
  const std::int32_t last = way.fixed_beats != 0 ? way.fixed_beats : way.last_beats;
  while (first <= last && !reach(way.allowed[index(a)], q, first, limit, side)) ++first;
  if (first <= last) widen(hull, side);
  if (first < last && reach(way.allowed[index(a)], q, last, limit, side)) widen(hull, side);
  return {hull.lo_q32 - guide_slack_q32, hull.hi_q32 + guide_slack_q32};
}

}  // namespace

bool overlap(const Box& x, const Box& y, int axes) {
  for (int a = 0; a < axes; ++a)
    if (x[index(a)].lo_q32 > y[index(a)].hi_q32 || y[index(a)].lo_q32 > x[index(a)].hi_q32)
      return false;
  return true;
}

bool step(const Window& window, const Way& way, const Box& from, std::int32_t beats, Box& to) {
  if (beats > window.most_beats) return false;
  for (int a = 0; a < window.axes(); ++a) {
    SpeedInterval& side = to[index(a)];
    if (!reach(from[index(a)], way.displacement_q32[index(a)], beats, window.speed_limit_q32(a),
               side))
      return false;
    if (!cut(side, way.allowed[index(a)])) return false;
  }
  return true;
}

bool step_back(const Window& window, std::uint32_t i, const Box& to, std::int32_t beats,
               Box& from) {
  const Way& way = window.ways[i];
  for (int a = 0; a < window.axes(); ++a) {
    SpeedInterval& side = from[index(a)];
    if (!reach(to[index(a)], way.displacement_q32[index(a)], beats, window.speed_limit_q32(a),
               side))
      return false;
    if (!cut(side, window.ways[i - 1].allowed[index(a)])) return false;
  }
  return true;
}

bool can_step(const Window& window, const Way& way, const Box& from, std::int32_t beats) {
  for (int a = 0; a < window.axes(); ++a)
    if (reachable(from[index(a)], way.displacement_q32[index(a)], beats,
                  window.speed_limit_q32(a)) == Reachable::no)
      return false;
  return true;
}

std::int32_t beats_at_rest(const Window& window, const Way& way, std::int32_t most) {
  std::int32_t beats = way.first_beats;
  for (int a = 0; a < window.axes(); ++a) {
    const std::int64_t q = abs64(way.displacement_q32[index(a)]);
    const std::int64_t limit = window.speed_limit_q32(a);
    while (beats <= most && most_from_rest_q32(beats, limit) < q) ++beats;
  }
  return beats <= most ? beats : 0;
}

void guide(Window& window) {
  for (std::uint32_t i = window.count; --i > 0;) {
    const Way& way = window.ways[i];
    for (int a = 0; a < window.axes(); ++a)
      cut(window.ways[i - 1].allowed[index(a)], hull_before(window, way, a));
  }
}

}  // namespace lamplock::motion
