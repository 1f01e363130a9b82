// A picture of the temperature along a path, seen from above, as SVG.
//
// In:  a run, its moves, a limit. Out: text of an SVG file. Who: `lamplock heat PROGRAM --picture`.
//
// The colour of each place is the largest temperature of the surface while the beam is there;
// places above the limit have a red border. A panel below has the temperature over time.
#pragma once

#include <string>
#include <vector>

#include "host/thermal/path_run.hpp"

namespace lamplock::thermal {

/// `title` is plain text.
std::string path_picture(const PathResult& result, const std::vector<BeamMove>& moves,
                         double limit_k, const std::string& title);

}  // namespace lamplock::thermal
