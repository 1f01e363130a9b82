#include "firmware/motion/path/reach.hpp"

#include "firmware/motion/path/real.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::motion {
namespace {

std::int64_t square_q32(std::int64_t v_q32) { return mul_q32(v_q32, v_q32); }

/// Least time from a speed in `from` to one in 0 ... end, Q32 beats, nearly exact.
std::int64_t min_time_q32(const PathWay& way, const SpeedInterval& from, std::int64_t end) {
  const std::int64_t start = from.hi_q32, twice = 2 * way.displacement_q32;
  const std::int64_t start_square = square_q32(start), end_square = square_q32(end);
  // Braking all the way, from the highest speed that can stop there.
  if (start_square > end_square + twice) {
    const std::int64_t most = sqrt_down_q32(end_square + twice);
    return (most > from.lo_q32 ? most : from.lo_q32) - end;
  }
  // Accelerating all the way.
  if (start_square + twice <= end_square) return sqrt_down_q32(start_square + twice) - start;
  const std::int64_t peak = sqrt_down_q32((twice + start_square + end_square) / 2);
  if (peak <= way.speed_q32) return 2 * peak - start - end;
  const std::int64_t up = square_q32(way.speed_q32 - start), down = square_q32(way.speed_q32 - end);
  return (Real::of_q32((twice + up + down) / 2) / Real::of_q32(way.speed_q32)).fixed(32);
}

}  // namespace

bool path_reach(const PathWay& way, const SpeedInterval& from, std::int32_t beats, std::int64_t end,
                SpeedInterval& to) {
  const std::int64_t half = way.speed_q32 / 2;
  const std::int64_t last = 2 * half;
  const SpeedInterval seen{(from.lo_q32 < last ? from.lo_q32 : last) - half,
                           (from.hi_q32 < last ? from.hi_q32 : last) - half};
  const std::int64_t frame = times_short(half, static_cast<std::uint32_t>(beats));
  if (!reach(seen, way.displacement_q32 - frame, beats, half, to)) return false;
  to.lo_q32 += half;
  to.hi_q32 += half;
  if (to.hi_q32 > end) to.hi_q32 = end;
  return to.lo_q32 <= to.hi_q32;
}

std::int32_t fewest_beats(const PathWay& way, const SpeedInterval& from, std::int64_t end,
                          std::int32_t least, std::int32_t most) {
  // Despite rounding of the time, the whole beat is this one or the next.
  const std::int64_t time = min_time_q32(way, from, end);
  const std::int64_t first = (time - (time >> 20) + one_q32 - 64) >> 32;
  if (first > most) return 0;
  const std::int32_t beats = first > least ? static_cast<std::int32_t>(first) : least;
  SpeedInterval to;
  for (std::int32_t k = beats; k <= beats + 1 && k <= most; ++k)
    if (path_reach(way, from, k, end, to)) return k;
  return 0;
}

}  // namespace lamplock::motion
