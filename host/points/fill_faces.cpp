#include "host/points/fill_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "host/geometry/limits.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/surface_blocks.hpp"
#include "host/points/weld.hpp"

namespace lamplock::points {
namespace {

/// Neighbours of the arrangement are this much further apart than the wanted distance, so that
/// weld() does not remove them by rounding.
constexpr double face_rounding = 1e-9;

/// A triangle on its longest side: the side begins at `origin` in the direction of the unit vector
/// `along`, the third corner is at distance `foot` along it and `height` in direction `away`.
struct Frame {
  geometry::Point origin, along, away;
  double length = 0, foot = 0, height = 0;
};

/// The side begins at the vertex of the lower index; among equal sides that of the lowest vertices
/// is used: so two triangles with a common longest side get the same points on it.
Frame frame_of(const model::Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  std::array<std::uint32_t, 3> order = triangle;
  std::sort(order.begin(), order.end());
  constexpr std::array<std::array<std::size_t, 3>, 3> sides{{{0, 1, 2}, {0, 2, 1}, {1, 2, 0}}};
  Frame frame;
  geometry::Point third;
  for (const auto& [from, to, other] : sides) {
    const geometry::Point way = difference(mesh.vertices[order[to]], mesh.vertices[order[from]]);
    const double length = std::sqrt(dot(way, way));
    if (length <= frame.length) continue;
    frame.origin = mesh.vertices[order[from]];
    frame.along = {way.x / length, way.y / length, way.z / length};
    frame.length = length;
    third = difference(mesh.vertices[order[other]], frame.origin);
  }
  frame.foot = dot(third, frame.along);
  const geometry::Point up = difference(
      third, {frame.foot * frame.along.x, frame.foot * frame.along.y, frame.foot * frame.along.z});
  frame.height = std::sqrt(dot(up, up));
  if (frame.height > 0) {
    frame.away = {up.x / frame.height, up.y / frame.height, up.z / frame.height};
  }
  return frame;
}

/// Fills rows from the longest side to the third corner; every other one is shifted by half a step.
void fill(const Frame& frame, double distance_mm, geometry::PointCloud& cloud) {
  const double step = distance_mm * (1 + face_rounding);
  const double row_mm = step * std::numbers::sqrt3 / 2;
  const double rows = std::floor(frame.height / row_mm + face_rounding) + 1;
  const double about = frame.length * frame.height / 2 / (step * row_mm);
  geometry::require_count(static_cast<double>(cloud.size()) + std::max(about, rows), "faces");
  for (std::int64_t row = 0; row < static_cast<std::int64_t>(rows); ++row) {
    const double away = static_cast<double>(row) * row_mm;
    const double up = std::min(away / frame.height, 1.0);
    const double from = frame.foot * up, to = frame.length - (frame.length - frame.foot) * up;
    const double offset = row % 2 == 0 ? 0 : step / 2;
    const double first = std::ceil((from - offset) / step - face_rounding);
    const double count = std::floor((to - offset) / step + face_rounding) - first + 1;
    geometry::require_count(static_cast<double>(cloud.size()) + count, "faces");
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i) {
      const double along = offset + (first + static_cast<double>(i)) * step;
      const auto at = [&](double geometry::Point::*axis) {
        return frame.origin.*axis + along * frame.along.*axis + away * frame.away.*axis;
      };
      cloud.push_back({at(&geometry::Point::x), at(&geometry::Point::y), at(&geometry::Point::z)});
    }
  }
}

}  // namespace

FaceFill fill_faces(const model::Mesh& mesh, const FaceFillOptions& options) {
  geometry::require_positive(options.distance_mm, "faces", "distance");
  if (options.smallest_side_mm != 0) {
    geometry::require_positive(options.smallest_side_mm, "faces", "smallest side");
  }
  require_sound(mesh, "faces");
  const double smallest =
      options.smallest_side_mm > 0 ? options.smallest_side_mm : options.distance_mm;
  FaceFill result;
  geometry::PointCloud cloud;
  for (const auto& triangle : mesh.triangles) {
    const Frame frame = frame_of(mesh, triangle);
    if (!(frame.length >= smallest) || !(frame.height > 0)) {
      ++result.rejected;
      continue;
    }
    fill(frame, options.distance_mm, cloud);
  }
  WeldResult welded = weld(std::move(cloud), options.distance_mm);
  result.points = std::move(welded.points);
  result.welded = welded.removed;
  return result;
}

}  // namespace lamplock::points
