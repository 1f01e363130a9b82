// Single entities of a DXF as geometry (Autodesk, "DXF Reference", ENTITIES section).
//
// In:  the groups of one entity. Out: a path, a polyline, a point, the placement of a block; in the
//      units of the drawing and the coordinates of the world.
// Who: read_dxf().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/dxf_groups.hpp"

namespace lamplock::model {

/// The curve of a LINE, LWPOLYLINE, ARC, CIRCLE, ELLIPSE or SPLINE; empty for any other kind and
/// for splines without poles. Throws Error (bad_input) for numbers that define no curve.
std::optional<Path> dxf_path(const DxfGroups& dxf, const DxfEntity& entity);

/// True if a POLYLINE is a surface, a mesh of vertices.
bool is_dxf_surface(const DxfGroups& dxf, const DxfEntity& polyline);
/// The curve of a POLYLINE with its VERTEX entities.
Path dxf_polyline(const DxfGroups& dxf, const DxfEntity& polyline,
                  const std::vector<DxfEntity>& vertices);

/// Copies of a block: column c and row r are placed by
/// frame * moved(c * column, r * row) * scale * moved(-base).
struct DxfInsert {
  std::string block;
  geometry::Affine frame, scale;
  int columns = 1, rows = 1;
  double column = 0, row = 0;
};
DxfInsert dxf_insert(const DxfGroups& dxf, const DxfEntity& insert);

}  // namespace lamplock::model
