// A chart of a motion: position, speed, acceleration and jerk of each axis over time, as SVG.
//
// In:  places at the steps of control, the limits of the axes. Out: text of an SVG file, some 30 KB
//      a curve at most: samples in one pixel are drawn once.
// Who: `lamplock jerk --chart`.
//
// Limits are dashed lines. Colours are those of Okabe and Ito, which colour-blind people can
// distinguish.
#pragma once

#include <string>
#include <vector>

#include "host/feed_optimiser/optimise.hpp"

namespace lamplock::feed_optimiser {

/// `title` is plain text.
std::string motion_chart(const std::vector<OptimisedBlock>& blocks, const Method& method,
                         const std::string& title);

}  // namespace lamplock::feed_optimiser
