// Drawings in DXF, text or binary (Autodesk, "DXF Reference"), release 12 and later.
//
// In:  a file. Out: its curves and points in mm.
// Who: read_input(); read_point_list() for files of points only; the use case of cutting, with
// texts.
//
// It reads LINE, LWPOLYLINE and POLYLINE with their bulges, ARC, CIRCLE, ELLIPSE, SPLINE, the
// outlines of HATCH, SOLID and TRACE, the visible edges of 3DFACE, POINT and INSERT of blocks,
// turned, scaled and in arrays; $INSUNITS gives the unit, none means mm with a warning. Boundaries
// of a HATCH whose source objects are in the drawing are drawn once. Left out and counted: all
// other entities, those on layers that are off or frozen ("hidden") or on paper ("paper space"),
// splines without poles, blocks of other files.
#pragma once

#include <filesystem>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::model {

/// Throws Error (bad_input) naming the file, and the line if possible: missing or empty file,
/// DWG, cut off, not a number, not finite or beyond farthest_mm, an invalid spline, a
/// block that contains itself or does not exist, more than max_pieces, nothing to draw.
Curves read_dxf(const std::filesystem::path& path);

/// The same with TEXT, MTEXT and the attributes of blocks, which are not counted as left out.
LetteredDrawing read_dxf_with_texts(const std::filesystem::path& path);

}  // namespace lamplock::model
