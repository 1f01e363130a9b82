// Size and place. Comes in: a mesh in its file's units, or a cloud. Goes out: the same in mm, where
// the user wants it. Called between the readers and the discretisers; point lists are only moved if
// that is asked for. Maps themselves are in affine.hpp; here is what placing objects needs of them.
#pragma once

#include <optional>

#include "host/model/affine.hpp"
#include "host/model/mesh.hpp"
#include "host/points/bounds.hpp"

namespace lamplock::model {

using points::Bounds;
using points::bounds;

/// Turns about an axis through the origin, counter-clockwise for who looks against it. The axis
/// needs a length that is finite and not 0; how long it is does not matter.
Affine turned_about(const points::Point& axis, double degrees);

/// The same map with `pivot` in the place of the origin.
Affine about(const Affine& map, const points::Point& pivot);

/// Volumes grow by this factor; negative if left and right are exchanged.
double determinant(const Affine& map);

/// The way back. Nothing if the map is flat or not finite.
std::optional<Affine> inverse(const Affine& map);

/// The mesh with the middle of its box in the origin, scaled evenly so that the longest side of the
/// box is `longest_side_mm`. Throws Error (bad_input) if the size is not positive or the mesh has
/// no extent.
Mesh centred_and_scaled(Mesh mesh, double longest_side_mm);

/// The map that does the same to whatever has this box.
Affine centring_and_scaling(const Bounds& box, double longest_side_mm);

/// The map for a program whose y axis points up (usual for OBJ): (x, y, z) -> (x, -z, y).
Affine y_up_to_z_up();
Mesh y_up_to_z_up(Mesh mesh);

/// The mesh under a map. A map that mirrors also exchanges two corners of every triangle, so that
/// outward stays outward.
Mesh transformed(Mesh mesh, const Affine& map);

/// The cloud under a map, in the same order.
points::PointCloud transformed(points::PointCloud cloud, const Affine& map);

}  // namespace lamplock::model
