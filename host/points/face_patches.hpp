// Groups neighbouring triangles of a mesh that are nearly in one plane. In: a mesh in mm. Out:
// patches of triangles. Called by fill_faces().
#pragma once

#include <cstdint>
#include <vector>

#include "host/model/mesh.hpp"

namespace lamplock::points {

/// Triangles of one patch; their normals differ from that of the first, which has the largest area,
/// by at most the angle.
using FacePatch = std::vector<std::uint32_t>;

/// Patches of the triangles with `usable[i]`, each triangle in one of them, those of large
/// triangles first. Normals of opposite direction count as the same, so orientation does not
/// matter. All usable triangles must have an area.
std::vector<FacePatch> face_patches(const model::Mesh& mesh, const std::vector<bool>& usable,
                                    double max_angle_deg);

}  // namespace lamplock::points
