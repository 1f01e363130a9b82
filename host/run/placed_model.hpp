// A model read and put into its place in the glass.
//
// In:  an object of a description, the volume. Out: mesh, curves or points in coordinates of the
//      glass. Who: discretise.cpp.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/glass/volume.hpp"
#include "host/model/curves.hpp"
#include "host/model/input.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::run {

/// A model in its place. Bitmaps are points by now.
struct PlacedModel {
  model::InputKind kind = model::InputKind::points;
  std::variant<geometry::PointCloud, model::Mesh, model::Curves> model{};
  std::string what{};  ///< for people: "1280 triangles"
  std::vector<std::string> warnings{};

  geometry::Bounds box() const;
};

/// Reads and places. `spacing_mm`: of the points of bitmaps. Throws Error(bad_input), also for a
/// mesh or drawing that is larger than the place for it.
PlacedModel placed_model(const glass::Object& object, double spacing_mm,
                         const glass::Volume& volume);

/// "40 x 30.5 x 12 mm".
std::string size_text(const geometry::Bounds& box);

}  // namespace lamplock::run
