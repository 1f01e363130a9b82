// Which contours of a cutting job are parts and which are holes.
//
// In:  the shapes of a drawing, the description of the job. Out: their places in the tree of
//      contours; warnings. Who: the use case of cutting.
#pragma once

#include <string>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/run/cut_description.hpp"

namespace lamplock::run {

/// As cutting::place_shapes(). Operations that are off count: a hole remains a hole if its part is
/// not cut in this run.
void place_cut_shapes(std::vector<cutting::Shape>& shapes, const CutDescription& description);

/// One text for each operation with cut contours that are parts, and would be holes if contours
/// without an operation and those of the kind ignore counted, or the other way around; only where
/// the side of the beam or of leads depends on that. `operations`: with their values.
std::vector<std::string> place_warnings(const std::vector<cutting::Shape>& shapes,
                                        const std::vector<cutting::Operation>& operations,
                                        const CutDescription& description);

}  // namespace lamplock::run
