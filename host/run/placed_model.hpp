// A model read and put into its place in the glass.
//
// In:  an object of a description, the volume. Out: mesh, curves, picture or points in coordinates
//      of the glass, none of which was made into points yet. Who: discretise.cpp.
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
#include "host/points/picture_frame.hpp"

namespace lamplock::run {

/// A picture in its place: its layers are round the frame.
struct PlacedPicture {
  model::Bitmap bitmap{};
  points::PictureFrame frame{};
  double thickness_mm = 0;  ///< from the first layer to the last
};

/// A model in its place.
struct PlacedModel {
  model::InputKind kind = model::InputKind::points;
  std::variant<geometry::PointCloud, model::Mesh, model::Curves, PlacedPicture> model{};
  std::string what{};  ///< for people: "1280 triangles"
  std::vector<std::string> warnings{};

  geometry::Bounds box() const;
};

/// Reads and places. `layer_mm`: from layer to layer of a picture. Throws Error(bad_input), also
/// for a mesh or drawing that is larger than the place for it.
PlacedModel placed_model(const glass::Object& object, double layer_mm, const glass::Volume& volume);

/// "40 x 30.5 x 12 mm".
std::string size_text(const geometry::Bounds& box, int digits = 4);

}  // namespace lamplock::run
