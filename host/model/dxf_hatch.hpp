// The boundary of a HATCH of a DXF as curves (Autodesk, "DXF Reference", HATCH and its boundary
// path data).
//
// In:  the groups of a HATCH. Out: its boundary paths: polylines with bulges; lines, arcs, ellipses
//      and splines joined to chains. The lines of the pattern are not drawn.
// Who: read_dxf().
#pragma once

#include <string>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/dxf_groups.hpp"

namespace lamplock::model {

/// One boundary path.
struct DxfBoundary {
  std::vector<Path> paths;
  /// Handles of the entities that it was made of, which are in the drawing too; often none.
  std::vector<std::string> sources;
};

/// In the units of the drawing and the coordinates of the world. Throws Error (bad_input) for
/// numbers that define no curve.
std::vector<DxfBoundary> dxf_hatch(const DxfGroups& dxf, const DxfEntity& hatch);

}  // namespace lamplock::model
