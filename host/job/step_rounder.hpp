// Converts points in mm to steps of a machine.
//
// In:  a point. Out: the nearest step of each axis, if that is inside the work space.
// Who: the makers of jobs of points and of rows.
#pragma once

#include <array>
#include <string>

#include "host/geometry/point.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"
#include "shared/work_space.hpp"

namespace lamplock::job {

/// Number of axes of a point.
inline constexpr int point_axes = 3;

/// Rounds points to steps inside the work space.
class Rounder {
 public:
  explicit Rounder(const settings::Values& values);

  /// False if the point is outside, or not finite.
  bool round(const geometry::Point& point, StepPosition& steps) const;

 private:
  StepLimits limits_;
  std::array<double, point_axes> steps_per_mm_{};
};

/// "X -50..50, Y -50..50, Z 0..20 mm".
std::string describe_work_space(const settings::Values& values);

}  // namespace lamplock::job
