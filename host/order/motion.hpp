// Limits of the machine that an order depends on: those of the three axes, and the beat. Used by
// all orderings; the default is the default machine profile.
#pragma once

#include <array>

namespace lamplock::order {

/// Limits of x, y and z, and the time between two flashes of the lamp.
struct Motion {
  std::array<double, 3> accel_mm_s2{4000, 4000, 4000};
  std::array<double, 3> speed_mm_s{1000, 1000, 1000};
  double beat_s = 0.01;
};

}  // namespace lamplock::order
