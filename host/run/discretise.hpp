// One object: from its file to points in the glass.
//
//   read -> place (size, transformations) -> points by a method -> shells, depth, weld -> check
//
// Meshes, drawings and bitmaps are placed before they become points, so that spacings hold in the
// glass; point lists are points that are placed. Meshes, drawings and bitmaps begin in the middle
// of the block; point lists begin where they are and are engraved exactly as given unless there is
// a transformation.
//
// In:  an object of a description, the volume. Out: its points and what is to be known about them.
// Who: prepare.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/glass/volume.hpp"
#include "host/model/input.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

/// What came of an object.
struct ObjectPoints {
  model::InputKind kind = model::InputKind::points;
  geometry::PointCloud points{};
  std::string way{};         ///< method of a mesh, otherwise the kind of the file
  double spacing_mm = 0;     ///< that was asked for; 0 for point lists
  double distance_mm = 0;    ///< no two of them are closer; 0 for point lists
  double layer_mm = 0;       ///< from layer to layer
  std::size_t welded = 0;    ///< points left out because too close to another
  std::size_t rejected = 0;  ///< triangles that the method leaves out
  double empty_share = 0;    ///< of the surface of a mesh, 0..1, without points near it
  std::vector<std::string> warnings{};
  std::vector<std::string> hints{};  ///< questions about size and position (size_hints.hpp)
};

/// The spacing of an object: as said, else that of the lens, else 0.1 mm.
double spacing_mm(const glass::Object& object, const glass::GlassChoice& glass);

/// Reads an object and makes points of it, all where points may be. Throws Error(bad_input).
ObjectPoints object_points(const glass::Object& object, const glass::GlassChoice& glass,
                           const glass::Volume& volume, Frontend& frontend);

/// The box round the points of an object, checked. Of a mesh it is the box of the mesh, which no
/// point leaves: its points would take their time. Throws Error(bad_input).
geometry::Bounds object_bounds(const glass::Object& object, const glass::GlassChoice& glass,
                               const glass::Volume& volume);

}  // namespace lamplock::run
