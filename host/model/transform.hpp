// Size and place. Comes in: a mesh in its file's units. Goes out: the same in mm, where the user
// wants it. Called between the readers and the discretisers; point lists are never moved.
#pragma once

#include "host/model/mesh.hpp"
#include "host/points/bounds.hpp"

namespace lamplock::model {

using points::Bounds;
using points::bounds;

/// The mesh with the middle of its box in the origin, scaled evenly so that the longest side of the
/// box is `longest_side_mm`. Throws Error (bad_input) if the size is not positive or the mesh has
/// no extent.
Mesh centred_and_scaled(Mesh mesh, double longest_side_mm);

/// The mesh of a program whose y axis points up (usual for OBJ) with z up: (x, y, z) -> (x, -z, y).
Mesh y_up_to_z_up(Mesh mesh);

}  // namespace lamplock::model
