// Path data of SVG (W3C, "Scalable Vector Graphics (SVG) 1.1", chapter 8 and appendix F.6).
//
// In:  the text of a `d` attribute. Out: one path per subpath, in the units of the text; arcs stay
//      arcs, Bezier curves become splines.
// Who: read_svg().
#pragma once

#include <string_view>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/file_position.hpp"

namespace lamplock::model {

/// Subpaths that draw nothing are left out. Throws Error (bad_input) naming file and line for
/// invalid data, or more than max_pieces.
std::vector<Path> svg_path(std::string_view data, const FilePosition& place);

}  // namespace lamplock::model
