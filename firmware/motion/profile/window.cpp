#include "firmware/motion/profile/window.hpp"

namespace lamplock::motion {
namespace {

/// reach() rounds inwards; a guide must not exclude what is just possible.
constexpr std::int32_t guide_slack_qs = 8;

/// Intersects a range with another one; false if the result is empty.
bool cut(SpeedRange& side, const SpeedRange& to) {
  if (side.lo_qs < to.lo_qs) side.lo_qs = to.lo_qs;
  if (side.hi_qs > to.hi_qs) side.hi_qs = to.hi_qs;
  return !side.empty();
}

void widen(SpeedRange& hull, const SpeedRange& by) {
  if (by.lo_qs < hull.lo_qs) hull.lo_qs = by.lo_qs;
  if (by.hi_qs > hull.hi_qs) hull.hi_qs = by.hi_qs;
}

MeanSpeed mean_of(const Leg& way, int a, std::int32_t beats) {
  return mean_speed(way.displacement_qs[index(a)], beats);
}

/// True if a displacement fits between two rests in this time: half of it to the top speed, at most
/// to the limit.
bool fits_between_rests(const AxisScale& axis, std::int64_t way, std::int32_t beats) {
  if (beats < axis.lasting_beats) {
    const std::int32_t half = (beats << axis.bits) / 2;
    if (half <= axis.limit_qs)
      return static_cast<std::int64_t>(
                 wide_product(static_cast<std::uint32_t>(half), static_cast<std::uint32_t>(beats)) /
                 2) >= way;
  }
  const auto limit = static_cast<std::uint32_t>(axis.limit_qs);
  const auto ramp = wide_product(limit, limit) >> axis.bits;
  return static_cast<std::int64_t>(wide_product(limit, static_cast<std::uint32_t>(beats)) - ramp) >=
         way;
}

/// Lower bound of the beats between two rests.
std::int32_t min_between_rests(const AxisScale& axis, std::int64_t way) {
  const auto beats = static_cast<std::int32_t>(
      nearly_isqrt(static_cast<std::uint64_t>(way) << 2 >> axis.bits));  // t^2 / 4 = way
  if (beats < 2 * (axis.limit_qs >> axis.bits)) return beats;
  return static_cast<std::int32_t>(way / axis.limit_qs) + (axis.limit_qs >> axis.bits);
}

/// Hull of one axis at the start of a way: both bounds are reached with the fewest and with the
/// most beats, since each falls and then rises, or rises and then falls, with the time.
SpeedRange hull_before(const Window& window, const Leg& way, int a) {
  const AxisScale& axis = window.scale(a);
  SpeedRange hull{}, side;
  std::int32_t first = way.fixed_beats != 0 ? way.fixed_beats : way.first_beats;
  const std::int32_t last = way.fixed_beats != 0 ? way.fixed_beats : way.last_beats;
  const SpeedRange& to = way.allowed[index(a)];
  while (first <= last && !reach(axis, to, mean_of(way, a, first), first, side)) ++first;
  if (first <= last) widen(hull, side);
  if (first < last && reach(axis, to, mean_of(way, a, last), last, side)) widen(hull, side);
  return {hull.lo_qs - guide_slack_qs, hull.hi_qs + guide_slack_qs};
}

}  // namespace

bool overlap(const Box& x, const Box& y, int axes) {
  for (int a = 0; a < axes; ++a)
    if (x[index(a)].lo_qs > y[index(a)].hi_qs || y[index(a)].lo_qs > x[index(a)].hi_qs)
      return false;
  return true;
}

bool step(const Window& window, const Leg& way, const Box& from, std::int32_t beats, Box& to) {
  if (beats > window.max_beats) return false;
  for (int a = 0; a < window.axes(); ++a) {
    SpeedRange& side = to[index(a)];
    if (!reach(window.scale(a), from[index(a)], mean_of(way, a, beats), beats, side)) return false;
    if (!cut(side, way.allowed[index(a)])) return false;
  }
  return true;
}

bool step_back(const Window& window, std::uint32_t i, const Box& to, std::int32_t beats,
               Box& from) {
  const Leg& way = window.ways[i];
  for (int a = 0; a < window.axes(); ++a) {
    SpeedRange& side = from[index(a)];
    if (!reach(window.scale(a), to[index(a)], mean_of(way, a, beats), beats, side)) return false;
    if (!cut(side, window.ways[i - 1].allowed[index(a)])) return false;
  }
  return true;
}

bool can_join(const Window& window, const Leg& way, const Box& from, const Box& to,
              std::int32_t beats) {
  for (int a = 0; a < window.axes(); ++a)
    if (!can_join(window.scale(a), from[index(a)], to[index(a)], way.displacement_qs[index(a)],
                  beats))
      return false;
  return true;
}

std::int32_t beats_at_rest(const Window& window, const Leg& way, std::int32_t most) {
  std::int32_t beats = way.first_beats;
  for (int a = 0; a < window.axes(); ++a) {
    const std::int64_t q = abs64(way.displacement_qs[index(a)]);
    if (fits_between_rests(window.scale(a), q, beats)) continue;
    const std::int32_t least = min_between_rests(window.scale(a), q);
    if (beats < least) beats = least;
    while (beats <= most && !fits_between_rests(window.scale(a), q, beats)) ++beats;
  }
  return beats <= most ? beats : 0;
}

namespace {

/// Raises the minimum beats to those from the best speed that is allowed at the start.
void raise_first_beats(const Window& window, Leg& way, const Box& from) {
  if (way.fixed_beats != 0) return;
  while (way.first_beats < way.last_beats &&
         !can_join(window, way, from, way.allowed, way.first_beats))
    ++way.first_beats;
}

}  // namespace

void guide(Window& window) {
  for (std::uint32_t i = window.count; --i > 0;) {
    Leg& way = window.ways[i];
    Box& before = window.ways[i - 1].allowed;
    for (int a = 0; a < window.axes(); ++a) cut(before[index(a)], hull_before(window, way, a));
    raise_first_beats(window, way, before);
  }
  raise_first_beats(window, window.ways[0], window.start);
}

}  // namespace lamplock::motion
