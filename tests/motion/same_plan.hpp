// Comparison of two plans of a chain.
#pragma once

#include <gtest/gtest.h>

#include <tuple>

#include "tests/motion/chain.hpp"

namespace lamplock::test {

/// Expects two plans to be equal to the last bit.
inline void expect_same_plan(const ChainPlan& plan, const ChainPlan& other) {
  ASSERT_EQ(plan.beats, other.beats);
  ASSERT_EQ(plan.segments.size(), other.segments.size());
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    const stepper::Segment &one = plan.segments[k], &two = other.segments[k];
    ASSERT_EQ(one.end.tick, two.end.tick) << "segment " << k;
    ASSERT_EQ(one.shot.half_window_ticks, two.shot.half_window_ticks) << "segment " << k;
    for (std::size_t a = 0; a < max_axes; ++a) {
      const auto all = [a](const stepper::Segment& s) {
        const stepper::AxisProfile& p = s.axis[a];
        const stepper::AxisState& end = s.end.axis[a];
        return std::tuple(p.speed_q62, p.lead_accel_q62, p.tail_accel_q62, p.lead_ticks,
                          p.cruise_ticks, p.tail_ticks, p.lead_turn_ticks, p.tail_turn_ticks,
                          p.lead_ramp, p.tail_ramp, end.position_q64.hi(), end.position_q64.lo(),
                          end.speed_q62);
      };
      ASSERT_EQ(all(one), all(two)) << "segment " << k << " axis " << a;
    }
  }
}

}  // namespace lamplock::test
