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

namespace lamplock::run {

/// Points of a mesh.
struct MeshPoints {
  geometry::PointCloud points{};
  bool keeps_spacing = false;  ///< the method itself keeps points apart
  std::size_t rejected = 0;    ///< triangles without a point
  std::vector<std::string> warnings{};
};

/// By the object's method, blue noise if it has none. Throws Error(bad_input).
MeshPoints mesh_points(const model::Mesh& mesh, const glass::Object& object, double spacing_mm);

}  // namespace lamplock::run
