#include "firmware/motion/reach.hpp"

namespace lamplock::motion {
namespace {

/// Least start speed from which `q` can be covered in `t`: accelerate all the way, at most to the
/// limit. The caller has checked |q| <= limit * t.
std::int64_t least_start_q32(std::int64_t q, std::int32_t t, std::int64_t limit) {
  const std::int64_t t_q32 = std::int64_t{t} << 32;
  const std::int64_t numerator = q - std::int64_t{t} * t_q32 / 2;
  // Rounded up: division truncates towards zero, one unit more is inside either way.
  const std::int64_t v = numerator / t + 1;
  if (v + t_q32 <= limit) return v;
  return limit - sqrt_down_q32(2 * (limit * t - q));
}

/// Largest end speed from start speed `v`: brake first, then accelerate; cut at the limit.
std::int64_t largest_end_q32(std::int64_t v, std::int64_t q, std::int32_t t, std::int64_t limit) {
  const std::int64_t t_q32 = std::int64_t{t} << 32;
  const std::int64_t u = sqrt_down_q32(2 * (std::int64_t{t} * t_q32) + 4 * (q - v * t)) - t_q32;
  const std::int64_t dip = v - (t_q32 - u + 1) / 2;
  const std::int64_t end =
      dip >= -limit
          ? v + u
          : sqrt_down_q32(2 * (q + limit * t) - mul_q32(v + limit, v + limit) - 1) - limit;
  return end < limit ? end : limit;
}

}  // namespace

bool reach(const SpeedInterval& from, std::int64_t q, std::int32_t t, std::int64_t limit,
           SpeedInterval& to) {
  if (abs64(q) > limit * t) return false;
  const std::int64_t least = least_start_q32(q, t, limit);
  const std::int64_t most = -least_start_q32(-q, t, limit);
  const std::int64_t lo = from.lo_q32 > least ? from.lo_q32 : least;
  const std::int64_t hi = from.hi_q32 < most ? from.hi_q32 : most;
  if (lo > hi) return false;
  // Both bounds fall with the start speed, hence the crossed arguments.
  to.hi_q32 = largest_end_q32(lo, q, t, limit);
  to.lo_q32 = -largest_end_q32(-hi, -q, t, limit);
  return to.lo_q32 <= to.hi_q32;
}

}  // namespace lamplock::motion
