// Size and position of models. In: a mesh in its file's units, or a cloud. Out: the same in mm, at
// the user's position. Called between the readers and the discretisers; point lists are moved on
// request only. Maps are in affine.hpp; this file has the operations for placing objects.
#pragma once

#include <optional>

#include "host/geometry/affine.hpp"
#include "host/geometry/bounds.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::model {

using geometry::Bounds;
using geometry::bounds;

/// Turns about an axis through the origin, counter-clockwise seen against it. The axis may have any
/// length that is finite and not 0.
geometry::Affine turned_about(const geometry::Point& axis, double degrees);

/// The same map about `pivot` instead of the origin.
geometry::Affine about(const geometry::Affine& map, const geometry::Point& pivot);

/// Volumes grow by this factor; negative if left and right are exchanged.
double determinant(const geometry::Affine& map);

/// The inverse. Empty if the map is flat or not finite.
std::optional<geometry::Affine> inverse(const geometry::Affine& map);

/// The mesh with the middle of its box in the origin, scaled evenly so that the longest side of the
/// box is `max_side_mm`. Throws Error (bad_input) if the size is not positive or the mesh has
/// no extent.
Mesh centred_and_scaled(Mesh mesh, double max_side_mm);

/// The map that does the same to any object with this box.
geometry::Affine centring_and_scaling(const Bounds& box, double max_side_mm);

/// The map for a program whose y axis points up (usual for OBJ): (x, y, z) -> (x, -z, y).
geometry::Affine y_up_to_z_up();
Mesh y_up_to_z_up(Mesh mesh);

/// The mesh under a map. A map that mirrors also exchanges two corners of every triangle, so that
/// normals still point outwards.
Mesh transformed(Mesh mesh, const geometry::Affine& map);

/// The cloud under a map, in the same order.
geometry::PointCloud transformed(geometry::PointCloud cloud, const geometry::Affine& map);

}  // namespace lamplock::model
