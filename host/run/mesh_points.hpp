// The methods that make points of a mesh, chosen by name.
//
// In:  a mesh in its place, the object's parameters. Out: points, and what got lost. Who:
//      discretise.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/model/mesh.hpp"
#include "host/points/slice.hpp"

namespace lamplock::run {

/// Points of a mesh.
struct MeshPoints {
  geometry::PointCloud points{};
  std::vector<std::size_t> first_of_layers{};  ///< of slices: index of the first point of each
  bool keeps_spacing = false;                  ///< the method itself keeps points apart
  std::size_t rejected = 0;                    ///< triangles that the method leaves out
  double empty_share = 0;  ///< of the surface, 0..1; 0 where the density is meant to vary
  std::vector<std::string> warnings{};
};

/// By the object's method, blue noise if it has none. Warns if a part of the surface has no point
/// near it. Throws Error(bad_input).
MeshPoints mesh_points(const model::Mesh& mesh, const glass::Object& object, double spacing_mm);

/// The planes of slices.
points::SliceFrame slice_frame_of(const glass::Object& object);

}  // namespace lamplock::run
