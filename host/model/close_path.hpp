// Closes the outlines of filled areas.
//
// In:  an open path in mm. Out: the path with the line that a fill has from its end to its start.
// Who: read_svg().
#pragma once

#include "host/model/curves.hpp"

namespace lamplock::model {

/// Appends the closing line to an open path. A path without area, all on one straight line, is left
/// open: its fill is not visible.
void close_around_area(Path& path);

}  // namespace lamplock::model
