// Watches the jerk of an axis from its accelerations, tick by tick.
//
// In:  the acceleration of every tick. Out: whether it ever changed by more than jerk x time plus
// one stair (guaranteed by pulse.hpp).
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/motion/profile/limits.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::test {

class JerkWatch {
 public:
  /// Before the first tick the acceleration is zero.
  explicit JerkWatch(const motion::AxisLimits& axis)
      : jerk_q62_(static_cast<double>(axis.jerk_q78) / 65536) {}

  /// Allows stairs of this many ticks from now on.
  void allow_stairs(std::uint32_t ticks) { stair_ = std::max(stair_, ticks); }
  void allow_stairs(const stepper::AxisProfile& p) {
    if (p.lead_ramp != 0) allow_stairs(stepper::ramp_of(p.lead_ticks, p.lead_ramp).stair_ticks);
    if (p.tail_ramp != 0) allow_stairs(stepper::ramp_of(p.tail_ticks, p.tail_ramp).stair_ticks);
  }

  /// Sets another initial acceleration.
  void start(double accel_q62) { least_ = most_ = accel_q62; }

  void tick(std::int64_t accel_q62) {
    // From any earlier tick t0 the change is at most J (t - t0): compare a -+ J t.
    ++ticks_;
    const auto accel = static_cast<double>(accel_q62);
    const double fallen = accel - jerk_q62_ * ticks_, risen = accel + jerk_q62_ * ticks_;
    least_ = std::min(least_, fallen);
    most_ = std::max(most_, risen);
    worst_ = std::max({worst_, fallen - least_, most_ - risen});
  }

  /// Largest change beyond jerk x time, in stairs.
  double worst() const { return worst_ / (jerk_q62_ * std::max(stair_, 1u)); }
  /// A thousandth is allowed for rounding.
  bool broken() const { return jerk_q62_ != 0 && worst() > 1.001; }

 private:
  double jerk_q62_, least_ = 0, most_ = 0, worst_ = 0;
  double ticks_ = 0;
  std::uint32_t stair_ = stepper::min_stair_ticks;
};

}  // namespace lamplock::test
