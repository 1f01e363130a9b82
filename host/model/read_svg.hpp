// Drawings in SVG (W3C, "Scalable Vector Graphics (SVG) 1.1"; SVG 2 where it is simpler).
//
// In:  a file. Out: the outlines of its shapes in mm, y upwards, the lower left corner of the page
//      in the origin.
// Who: the command line.
//
// It reads path, rect, circle, ellipse, line, polyline and polygon in groups, nested svg, symbols
// and use, with all transforms, view boxes and units (96 px an inch, as in CSS). The paint of a
// shape does not matter. A path's layer is that of Inkscape, otherwise the outermost group by its
// id. Left out and counted: text, images and other drawn elements; those with display:none
// ("hidden").
#pragma once

#include <filesystem>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// Throws Error (bad_input) naming the file and the line: missing or empty file, invalid XML or
/// path data, not finite or beyond farthest_mm, a use that contains itself or names no element,
/// groups nested too deeply, more than max_pieces, nothing to draw.
Curves read_svg(const std::filesystem::path& path);

}  // namespace lamplock::model
