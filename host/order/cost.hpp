// What a tour costs. Called by the local search and by the choice between tours.
#pragma once

#include <cmath>

#include "host/points/point.hpp"

namespace lamplock::order {

/// Weight of the change of step between two steps, per mm, against a mm of way. Tried on the
/// example model sliced at 0.3 mm with a greedy planner at 100 Hz and 2 m/s2: weight 0 gives 1.34
/// beats a point, 0.2 1.29, 0.5 to 0.7 1.20, 2 1.24; start-stop grows by 3 % from 0 to 0.5.
inline constexpr double bend_weight = 0.7;

inline double distance(const points::Point& p, const points::Point& q) {
  const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Cost of going p, q, r beyond the way itself: a second difference of zero is an even motion.
inline double bend(const points::Point& p, const points::Point& q, const points::Point& r) {
  const double x = p.x - 2 * q.x + r.x, y = p.y - 2 * q.y + r.y, z = p.z - 2 * q.z + r.z;
  return bend_weight * std::sqrt(x * x + y * y + z * z);
}

}  // namespace lamplock::order
