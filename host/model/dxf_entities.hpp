// Single entities of a DXF as geometry (Autodesk, "DXF Reference", ENTITIES section).
//
// In:  the groups of one entity. Out: a path, a polyline, a point, the placement of a block; in the
//      units of the drawing and the coordinates of the world.
// Who: read_dxf(), dxf_hatch().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/dxf_groups.hpp"

namespace lamplock::model {

/// The map from an entity's own coordinates to the world's, by its extrusion direction. Throws
/// Error (bad_input) if the direction is zero.
geometry::Affine dxf_world(const DxfGroups& dxf, const DxfEntity& entity);

/// A corner of a polyline; the bulge is that of the arc to the next one.
struct DxfVertex {
  geometry::Point at;
  double bulge = 0;
};
Path dxf_outline(const std::vector<DxfVertex>& vertices, bool closed,
                 const geometry::Affine& world);

/// The visible edges of a 3DFACE, each a path by itself, so that faces share the points of their
/// edges.
std::vector<Path> dxf_face(const DxfGroups& dxf, const DxfEntity& face);

/// The outline of a SOLID or TRACE.
Path dxf_solid(const DxfGroups& dxf, const DxfEntity& solid);

/// The curve of a LINE, LWPOLYLINE, ARC, CIRCLE, ELLIPSE, SPLINE, SOLID or TRACE; empty for any
/// other kind and for splines without poles. Throws Error (bad_input) for numbers that define no
/// curve.
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
