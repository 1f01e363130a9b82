// Speed, acceleration and jerk of each axis, from the places at the steps of control.
//
// In:  places, one per control period, from rest. Out: the largest values of each axis.
// Who: the optimiser for arcs; the table of `lamplock jerk`; the chart.
//
// Differences of the places divided by the period: they are what a drive that interpolates between
// the places has to follow.
#pragma once

#include <cstddef>
#include <limits>

#include "host/feed_optimiser/limits.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::feed_optimiser {

/// Derivatives of the position at one step, mm and s.
struct Motion {
  PerAxis speed{}, accel{}, jerk{};
};

class MotionMeter {
 public:
  explicit MotionMeter(double period_s) : period_s_(period_s) {}

  /// The next place; the first one has been the place for ever.
  void add(const geometry::Point& place);
  /// The machine stays at the last place.
  void finish();

  const Motion& now() const { return now_; }
  const Motion& max() const { return max_; }  ///< absolute values
  std::size_t places() const { return places_; }

 private:
  double period_s_;
  std::size_t places_ = 0;
  PerAxis last_{};
  Motion now_, max_;
};

/// The largest of |value| / limit over the axes and the three derivatives: at most 1 within limits.
struct Usage {
  double speed = 0, accel = 0, jerk = 0;
};
Usage usage_of(const Motion& motion, const AxisLimits& limits);

}  // namespace lamplock::feed_optimiser
