// Operations and plans of cuts for tests.
#pragma once

#include <vector>

#include "host/cutting/cut_plan.hpp"

namespace lamplock::test {

inline cutting::Operation operation(
    double kerf_mm, cutting::Compensation compensation = cutting::Compensation::automatic) {
  cutting::Operation one;
  one.name = "cut";
  one.power = 0.8;
  one.feed_mm_min = 600;
  one.kerf_mm = kerf_mm;
  one.compensation = compensation;
  return one;
}

/// The cuts of contours that are all of one operation, from the origin.
inline cutting::CutPlan plan_of(const std::vector<cutting::Contour>& contours,
                                const cutting::Operation& one) {
  std::vector<cutting::Shape> shapes;
  shapes.reserve(contours.size());
  for (const cutting::Contour& contour : contours) shapes.push_back({contour, {}, 0});
  place_shapes(shapes, {one});
  return plan_cuts(shapes, {one}, {0, 0});
}

}  // namespace lamplock::test
