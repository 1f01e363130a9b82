#include "host/model/transform.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "host/error.hpp"
#include "host/geometry/vector.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using geometry::radians_per_degree;

/// Exchanges two corners of every triangle, with the data of these corners.
void exchange_corners(Mesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  if (!mesh.brightness) return;
  for (auto& corners : mesh.brightness->corners) std::swap(corners[1], corners[2]);
  for (auto& textured : mesh.brightness->textured)
    std::swap(textured.corners[1], textured.corners[2]);
}

}  // namespace

geometry::Affine turned_about(const Point& axis, double degrees) {
  if (axis.y == 0 && axis.z == 0) return geometry::turned_about_x(axis.x < 0 ? -degrees : degrees);
  if (axis.x == 0 && axis.z == 0) return geometry::turned_about_y(axis.y < 0 ? -degrees : degrees);
  if (axis.x == 0 && axis.y == 0) return geometry::turned_about_z(axis.z < 0 ? -degrees : degrees);
  const Point u = times(axis, 1 / std::hypot(axis.x, axis.y, axis.z));
  const double sine = std::sin(degrees * radians_per_degree);
  const double cosine = std::cos(degrees * radians_per_degree);
  // Rodrigues' formula, for each unit vector.
  const auto turned = [&](const Point& v) {
    const Point square = cross(u, v), along = times(u, (1 - cosine) * dot(u, v));
    return Point{cosine * v.x + sine * square.x + along.x, cosine * v.y + sine * square.y + along.y,
                 cosine * v.z + sine * square.z + along.z};
  };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {}};
}

geometry::Affine about(const geometry::Affine& map, const Point& pivot) {
  return geometry::moved(pivot.x, pivot.y, pivot.z) * map *
         geometry::moved(-pivot.x, -pivot.y, -pivot.z);
}

double determinant(const geometry::Affine& map) { return dot(map.x, cross(map.y, map.z)); }

std::optional<geometry::Affine> inverse(const geometry::Affine& map) {
  const double volume = determinant(map);
  if (volume == 0 || !std::isfinite(volume)) return std::nullopt;
  // Rows of the inverse matrix are cross products of the columns of the matrix.
  const Point a = times(cross(map.y, map.z), 1 / volume);
  const Point b = times(cross(map.z, map.x), 1 / volume);
  const Point c = times(cross(map.x, map.y), 1 / volume);
  geometry::Affine back{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}, {}};
  back.offset = times(back.turn(map.offset), -1);
  return back;
}

geometry::Affine centring_and_scaling(const Bounds& box, double max_side_mm) {
  if (!(max_side_mm > 0) || !std::isfinite(max_side_mm)) {
    throw Error(Exit::bad_input, "size", fmt::format("{} mm", max_side_mm),
                "give the longest side in mm, greater than 0");
  }
  const double side = box.max_side();
  if (!(side > 0))
    throw Error(Exit::bad_input, "model", "it has no extent and cannot be scaled",
                "give a model of more than one point");
  const double scale = max_side_mm / side;
  // A double has no such side or no such scale.
  if (!std::isnormal(side) || !std::isnormal(scale))
    throw Error(
        Exit::bad_input, "model",
        fmt::format("its longest side, {:.3g}, is too small or too large to be scaled to {} mm",
                    side, max_side_mm),
        "export it with coordinates in mm");
  const Point centre = box.centre();
  return geometry::scaled(scale, scale, scale) * geometry::moved(-centre.x, -centre.y, -centre.z);
}

Mesh centred_and_scaled(Mesh mesh, double max_side_mm) {
  const geometry::Affine map = centring_and_scaling(bounds(mesh.vertices), max_side_mm);
  return transformed(std::move(mesh), map);
}

geometry::Affine y_up_to_z_up() { return {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}}; }

Mesh y_up_to_z_up(Mesh mesh) { return transformed(std::move(mesh), y_up_to_z_up()); }

Mesh transformed(Mesh mesh, const geometry::Affine& map) {
  for (Point& vertex : mesh.vertices) vertex = map(vertex);
  if (determinant(map) < 0) exchange_corners(mesh);
  return mesh;
}

geometry::PointCloud transformed(geometry::PointCloud cloud, const geometry::Affine& map) {
  for (Point& point : cloud) point = map(point);
  return cloud;
}

}  // namespace lamplock::model
