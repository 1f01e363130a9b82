// A picture of a plan, seen from above, as SVG: what the beam removes, in which order.
//
// In:  a plan with its shapes and operations, a title. Out: text of an SVG file.
// Who: `lamplock cut --picture`.
//
// The kerf is drawn to scale over the thin lines of the drawing, leads, tabs and overcuts in
// colours of their own, rapids dashed. The number of each cut is beside its begin.
#pragma once

#include <string>
#include <vector>

#include "host/cutting/cut_plan.hpp"

namespace lamplock::cutting {

/// `title` is plain text.
std::string plan_svg(const CutPlan& plan, const std::vector<Shape>& shapes,
                     const std::vector<Operation>& operations, const std::string& title);

}  // namespace lamplock::cutting
