// The background of a page: a filled rectangle that covers it.
//
// In:  an outline and the page, mm. Out: whether its edge is outside of what the page shows.
// Who: read_svg().
#pragma once

#include "host/geometry/bounds.hpp"
#include "host/model/curves.hpp"

namespace lamplock::model {

/// True if an outline is a rectangle along the axes that covers a page.
bool is_filled_box(const Path& outline, const geometry::Bounds& page);

}  // namespace lamplock::model
