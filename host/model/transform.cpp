#include "host/model/transform.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/error.hpp"

namespace lamplock::model {

Mesh centred_and_scaled(Mesh mesh, double longest_side_mm) {
  if (!(longest_side_mm > 0) || !std::isfinite(longest_side_mm)) {
    throw Error(Exit::bad_input, "size", fmt::format("{} mm", longest_side_mm),
                "give the longest side in mm, greater than 0");
  }
  const Bounds box = bounds(mesh.vertices);
  const double side = box.longest_side();
  if (!(side > 0) || !std::isfinite(side)) {
    throw Error(Exit::bad_input, "model", "it has no extent and cannot be scaled",
                "give a model of more than one point");
  }
  const double scale = longest_side_mm / side;
  const points::Point centre = box.centre();
  for (points::Point& vertex : mesh.vertices) {
    vertex = {(vertex.x - centre.x) * scale, (vertex.y - centre.y) * scale,
              (vertex.z - centre.z) * scale};
  }
  return mesh;
}

Mesh y_up_to_z_up(Mesh mesh) {
  for (points::Point& vertex : mesh.vertices) vertex = {vertex.x, -vertex.z, vertex.y};
  return mesh;
}

}  // namespace lamplock::model
