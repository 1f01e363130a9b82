// Drawings in SVG (W3C, "Scalable Vector Graphics (SVG) 1.1"; SVG 2 where it is simpler).
//
// In:  a file. Out: the outlines of its shapes in mm, y upwards, the lower left corner of the page
//      in the origin.
// Who: the command line.
//
// It reads path, rect, circle, ellipse, line, polyline and polygon in groups, nested svg, symbols
// and use, with all transforms, view boxes and units (96 px an inch, as in CSS), with the styles of
// style sheets, style attributes and presentation attributes. Drawn is what is visible: the outline
// of a shape whose fill or stroke is, within its clip paths, masks that are plain shapes and the
// views of nested svg; a dashed stroke as its dashes. The colour does not matter, except that a
// rectangle of the page's size under all others is its background. A path's layer is that of
// Inkscape, otherwise the outermost group by its id. Left out and counted: text, images and other
// drawn elements; what is invisible ("hidden"); elements with a clip path or mask that cannot be
// applied; rules of style sheets that are not understood.
#pragma once

#include <filesystem>

#include "host/model/curves.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::model {

/// Throws Error (bad_input) naming the file and the line: missing or empty file, invalid XML or
/// path data, not finite or beyond farthest_mm, a use that contains itself or names no element,
/// groups nested too deeply, more than max_pieces, nothing to draw.
Curves read_svg(const std::filesystem::path& path);

/// The same with texts, which are not counted as left out unless they are clipped or on a path.
LetteredDrawing read_svg_with_texts(const std::filesystem::path& path);

}  // namespace lamplock::model
