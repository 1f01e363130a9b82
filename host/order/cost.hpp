// Cost of a tour. Called by the local search and by the choice between tours.
//
// Two costs: the length and evenness in millimetres, for any machine, and an estimate of the beats
// that the planner of a given machine will waste.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "host/geometry/point.hpp"
#include "host/order/beat_model.hpp"

namespace lamplock::order {

/// Weight of the change between two steps, per mm, against a mm of length. Measured on the example
/// model sliced at 0.3 mm with a greedy planner at 100 Hz and 2 m/s2: weight 0 gives 1.34 beats a
/// point, 0.2 1.29, 0.5 to 0.7 1.20, 2 1.24; start-stop grows by 3 % from 0 to 0.5.
inline constexpr double bend_weight = 0.7;

inline double distance(const geometry::Point& p, const geometry::Point& q) {
  const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Cost of the turn p, q, r besides its length: a second difference of zero is an even motion.
inline double bend(const geometry::Point& p, const geometry::Point& q, const geometry::Point& r) {
  const double x = p.x - 2 * q.x + r.x, y = p.y - 2 * q.y + r.y, z = p.z - 2 * q.z + r.z;
  return bend_weight * std::sqrt(x * x + y * y + z * z);
}

/// The cost of a tour is the sum of its edges and of the turns between them.
class TourCost {
 public:
  /// Length and evenness: |d| + bend_weight |change of d|, mm.
  TourCost() = default;
  /// An estimate of the wasted beats on a machine. x is the change of step in units of A beat^2 of
  /// the slowest axis: up to about 1 the axis can usually make it within a beat; a jump of length x
  /// from rest to rest has a change of x at both ends and takes 2 sqrt(x) beats.
  explicit TourCost(const BeatModel& model)
      : beats_(true),
        per_mm_{1 / model.unit_mm(0), 1 / model.unit_mm(1), 1 / model.unit_mm(2)},
        way_per_mm_(way_weight * *std::min_element(per_mm_.begin(), per_mm_.end())) {}

  double edge(const geometry::Point& p, const geometry::Point& q) const {
    return way_per_mm_ * distance(p, q);
  }
  double turn(const geometry::Point& p, const geometry::Point& q, const geometry::Point& r) const {
    if (!beats_) return bend(p, q, r);
    const double x = std::max({std::abs(p.x - 2 * q.x + r.x) * per_mm_[0],
                               std::abs(p.y - 2 * q.y + r.y) * per_mm_[1],
                               std::abs(p.z - 2 * q.z + r.z) * per_mm_[2]});
    return x < 1 ? x * x : std::sqrt(x);
  }

 private:
  // Per A beat^2. The best of 0.1, 0.15, 0.3, 0.5 and 1 on the clouds of docs/ordering.md: with 0
  // tours skip single points and return for them later, with more they turn too often.
  static constexpr double way_weight = 0.3;

  bool beats_ = false;
  std::array<double, 3> per_mm_{1, 1, 1};
  double way_per_mm_ = 1;
};

}  // namespace lamplock::order
