// Drawings in DXF, text or binary (Autodesk, "DXF Reference"), release 12 and later.
//
// In:  a file. Out: its curves and points in mm.
// Who: the command line; read_point_list() for files of points only.
//
// It reads LINE, LWPOLYLINE and POLYLINE with their bulges, ARC, CIRCLE, ELLIPSE, SPLINE, the
// outlines of HATCH, SOLID and TRACE, the visible edges of 3DFACE, POINT and INSERT of blocks,
// turned, scaled and in arrays; $INSUNITS gives the unit, none means mm with a warning. Boundaries
// of a HATCH whose source objects are in the drawing are drawn once. Left out and counted: all
// other entities, those on layers that are off or frozen ("hidden") or on paper ("paper space"),
// splines without poles, blocks of other files.
#pragma once

#include <filesystem>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// Throws Error (bad_input) naming the file, and the line if possible: missing or empty file,
/// DWG, cut off, not a number, not finite or beyond farthest_mm, an invalid spline, a
/// block that contains itself or does not exist, more than max_pieces, nothing to draw.
Curves read_dxf(const std::filesystem::path& path);

}  // namespace lamplock::model
