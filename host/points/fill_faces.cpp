#include "host/points/fill_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "host/geometry/limits.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/face_patches.hpp"
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

/// Neighbours in a patch may differ so much from its plane: then points of the plane are up to 3.5
/// % further apart on the surface.
constexpr double max_patch_angle_deg = 15;

/// A corner of a triangle in the plane of a frame, and its place.
struct PlaneCorner {
  double along = 0, away = 0;
  geometry::Point place;
};

PlaneCorner corner_in(const Frame& frame, const geometry::Point& place) {
  const geometry::Point from = difference(place, frame.origin);
  return {dot(from, frame.along), dot(from, frame.away), place};
}

/// From where to where a row passes a triangle; empty (from > to) if it does not.
struct RowSpan {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  void add(double along) {
    from = std::min(from, along);
    to = std::max(to, along);
  }
};

RowSpan span_of(const std::array<PlaneCorner, 3>& corners, double away, double rounding_mm) {
  RowSpan span;
  for (std::size_t i = 0; i < 3; ++i) {
    const PlaneCorner &p = corners[i], &q = corners[(i + 1) % 3];
    const auto [low, high] = std::minmax(p.away, q.away);
    if (away < low - rounding_mm || away > high + rounding_mm) continue;
    if (high - low <= rounding_mm) {
      span.add(p.along);
      span.add(q.along);
      continue;
    }
    const double t = std::clamp((away - p.away) / (q.away - p.away), 0.0, 1.0);
    span.add(p.along + t * (q.along - p.along));
  }
  return span;
}

/// The place on a triangle over a place in the plane of the frame.
geometry::Point place_on(const std::array<PlaneCorner, 3>& c, double along, double away) {
  const double bu = c[1].along - c[0].along, bv = c[1].away - c[0].away;
  const double cu = c[2].along - c[0].along, cv = c[2].away - c[0].away;
  const double u = along - c[0].along, v = away - c[0].away, area = bu * cv - bv * cu;
  const double s = (u * cv - v * cu) / area, t = (bu * v - bv * u) / area;
  const geometry::Point &a = c[0].place, &b = c[1].place, &d = c[2].place;
  return {a.x + s * (b.x - a.x) + t * (d.x - a.x), a.y + s * (b.y - a.y) + t * (d.y - a.y),
          a.z + s * (b.z - a.z) + t * (d.z - a.z)};
}

/// Adds the points of the frame's arrangement that lie over a triangle: rows at whole multiples of
/// their distance from the longest side; every other one is shifted by half a step.
void fill(const Frame& frame, const Corners& triangle, double distance_mm,
          geometry::PointCloud& cloud) {
  const double step = distance_mm * (1 + face_rounding);
  const double row_mm = step * std::numbers::sqrt3 / 2;
  const std::array<PlaneCorner, 3> corners{
      corner_in(frame, triangle[0]), corner_in(frame, triangle[1]), corner_in(frame, triangle[2])};
  const auto [low, high] = std::minmax({corners[0].away, corners[1].away, corners[2].away});
  const double first_row = std::ceil(low / row_mm - face_rounding);
  const double rows = std::floor(high / row_mm + face_rounding) - first_row + 1;
  const double about = area_of(triangle) / (step * row_mm);
  geometry::require_count(static_cast<double>(cloud.size()) + std::max(about, rows), "faces");
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(rows); ++i) {
    const auto row = static_cast<std::int64_t>(first_row) + i;
    const double away = std::clamp(static_cast<double>(row) * row_mm, low, high);
    const RowSpan span = span_of(corners, away, face_rounding * step);
    const double offset = row % 2 == 0 ? 0 : step / 2;
    const double first = std::ceil((span.from - offset) / step - face_rounding);
    const double count = std::floor((span.to - offset) / step + face_rounding) - first + 1;
    if (!(count > 0)) continue;
    geometry::require_count(static_cast<double>(cloud.size()) + count, "faces");
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(count); ++k) {
      const double along = offset + (first + static_cast<double>(k)) * step;
      cloud.push_back(place_on(corners, std::clamp(along, span.from, span.to), away));
    }
  }
}

}  // namespace

FaceFill fill_faces(const model::Mesh& mesh, const FaceFillOptions& options) {
  geometry::require_positive(options.distance_mm, "faces", "distance");
  if (options.min_side_mm != 0) {
    geometry::require_positive(options.min_side_mm, "faces", "smallest side");
  }
  require_sound(mesh, "faces");
  FaceFill result;
  std::vector<bool> usable(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Frame frame = frame_of(mesh, mesh.triangles[i]);
    usable[i] =
        frame.length >= options.min_side_mm && frame.height > 0 && area_of(corners_of(mesh, i)) > 0;
    if (!usable[i]) ++result.rejected;
  }
  geometry::PointCloud cloud;
  for (const FacePatch& patch : face_patches(mesh, usable, max_patch_angle_deg)) {
    const Frame frame = frame_of(mesh, mesh.triangles[patch.front()]);
    for (const std::uint32_t triangle : patch)
      fill(frame, corners_of(mesh, triangle), options.distance_mm, cloud);
  }
  WeldResult welded = weld(std::move(cloud), options.distance_mm);
  result.points = std::move(welded.points);
  result.welded = welded.removed;
  return result;
}

}  // namespace lamplock::points
