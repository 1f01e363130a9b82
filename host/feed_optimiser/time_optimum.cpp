#include "host/feed_optimiser/time_optimum.hpp"

#include <cmath>

namespace lamplock::feed_optimiser {

double optimum_s(double length_mm, const PathLimits& limits) {
  const double v = limits.speed_mm_s, a = limits.accel_mm_s2, j = limits.jerk_mm_s3;
  const bool reaches_accel = v * j >= a * a;
  const double ramp_s = reaches_accel ? a / j + v / a : 2 * std::sqrt(v / j);
  if (v * ramp_s <= length_mm) return ramp_s + length_mm / v;
  if (length_mm <= 2 * a * a * a / (j * j)) return 4 * std::cbrt(length_mm / (2 * j));
  // The speed reached, from length = v (a / j + v / a).
  const double part = a * a / j;
  const double reached = (std::sqrt(part * part + 4 * length_mm * a) - part) / 2;
  return 2 * (a / j + reached / a);
}

}  // namespace lamplock::feed_optimiser
