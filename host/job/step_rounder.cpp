#include "host/job/step_rounder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "host/units.hpp"
#include "shared/units.hpp"

namespace lamplock::job {

using settings::Id;

Rounder::Rounder(const settings::Values& values) : limits_(work_space(values)) {
  for (int axis = 0; axis < point_axes; ++axis)
    steps_per_mm_[index(axis)] = in_units(values, Id::steps_per_mm_x, axis);
}

bool Rounder::round(const geometry::Point& point, StepPosition& steps) const {
  const std::array mm{point.x, point.y, point.z};
  for (int axis = 0; axis < point_axes; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double exact = std::round(mm[i] * steps_per_mm_[i]);
    if (!(std::abs(exact) <= std::numeric_limits<std::int32_t>::max())) return false;
    steps[i] = static_cast<std::int32_t>(exact);
    // An axis that the machine lacks has limits 0..0.
    if (!limits_.contains(axis, steps[i])) return false;
  }
  return true;
}

std::string describe_work_space(const settings::Values& values) {
  std::string text;
  for (int axis = 0; axis < values.whole(Id::axes); ++axis) {
    const double corner = in_units(values, Id::min_corner_x, axis);
    const double travel = in_units(values, Id::travel_x, axis);
    text += fmt::format("{}{} {:g}..{:g}", axis == 0 ? "" : ", ",
                        axis_letters[static_cast<std::size_t>(axis)], corner, corner + travel);
  }
  return text + " mm";
}

}  // namespace lamplock::job
