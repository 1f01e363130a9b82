#include "host/feed_optimiser/motion_meter.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::feed_optimiser {

void MotionMeter::add(const geometry::Point& place) {
  const PerAxis at{place.x, place.y, place.z};
  if (places_++ == 0) last_ = at;
  for (std::size_t a = 0; a < axes; ++a) {
    const double speed = (at[a] - last_[a]) / period_s_;
    const double accel = (speed - now_.speed[a]) / period_s_;
    const double jerk = (accel - now_.accel[a]) / period_s_;
    now_.speed[a] = speed;
    now_.accel[a] = accel;
    now_.jerk[a] = jerk;
    max_.speed[a] = std::max(max_.speed[a], std::abs(speed));
    max_.accel[a] = std::max(max_.accel[a], std::abs(accel));
    max_.jerk[a] = std::max(max_.jerk[a], std::abs(jerk));
  }
  last_ = at;
}

void MotionMeter::finish() {
  constexpr int differences = 3;
  for (int i = 0; i < differences; ++i) add({last_[0], last_[1], last_[2]});
}

Usage usage_of(const Motion& motion, const AxisLimits& limits) {
  Usage usage;
  for (std::size_t a = 0; a < axes; ++a) {
    usage.speed = std::max(usage.speed, std::abs(motion.speed[a]) / limits.speed_mm_s[a]);
    usage.accel = std::max(usage.accel, std::abs(motion.accel[a]) / limits.accel_mm_s2[a]);
    usage.jerk = std::max(usage.jerk, std::abs(motion.jerk[a]) / limits.jerk_mm_s3[a]);
  }
  return usage;
}

}  // namespace lamplock::feed_optimiser
