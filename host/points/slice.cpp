#include "host/points/slice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/affine.hpp"
#include "host/geometry/bounds.hpp"
#include "host/geometry/limits.hpp"
#include "host/points/contours.hpp"
#include "host/points/spread.hpp"

namespace lamplock::points {
namespace {

void require_finite(double value, const std::string& name) {
  if (std::isfinite(value)) return;
  throw Error(Exit::bad_input, "slice", fmt::format("{} is {}", name, value), "give a number");
}

void check(const SliceOptions& options) {
  geometry::require_positive(options.layer_mm, "slice", "layer distance");
  geometry::require_positive(options.vertex_mm, "slice", "vertex distance");
  require_finite(options.twist_mm, "twist");
  require_finite(options.first_mm.value_or(0), "first plane");
  require_finite(options.last_mm.value_or(0), "last plane");
  require_finite(options.first_offset_mm.value_or(0), "first offset");
  require_finite(options.last_offset_mm.value_or(0), "last offset");
  require_finite(options.frame.turn_x_deg, "angle about x");
  require_finite(options.frame.turn_y_deg, "angle about y");
  require_finite(options.frame.turn_z_deg, "angle about z");
  if ((options.first_mm && options.first_offset_mm) ||
      (options.last_mm && options.last_offset_mm)) {
    throw Error(Exit::bad_input, "slice", "a plane is given by position and by offset",
                "give one of them");
  }
}

/// The map from the frame of slicing, where planes have constant z, to that of the mesh.
geometry::Affine map_of(const SliceFrame& frame) {
  constexpr geometry::Point x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const geometry::Affine axes = frame.axis == geometry::Axis::x   ? geometry::Affine{y, z, x, {}}
                                : frame.axis == geometry::Axis::y ? geometry::Affine{z, x, y, {}}
                                                                  : geometry::Affine{};
  return geometry::turned_about_z(frame.turn_z_deg) * geometry::turned_about_y(frame.turn_y_deg) *
         geometry::turned_about_x(frame.turn_x_deg) * axes;
}

/// The mesh in the frame of slicing: `mesh` itself if the frames are equal, otherwise `turned`.
const model::Mesh& in_frame(const model::Mesh& mesh, const geometry::Affine& frame,
                            model::Mesh& turned) {
  if (frame == geometry::Affine{}) return mesh;
  const geometry::Affine into = geometry::turned_back(frame);
  turned = mesh;
  for (geometry::Point& vertex : turned.vertices) vertex = into(vertex);
  return turned;
}

Planes planes_for(const model::Mesh& mesh, const SliceOptions& options) {
  const geometry::Bounds box = bounds(mesh.vertices);
  const double low =
      options.first_mm.value_or(box.low.z + options.first_offset_mm.value_or(options.layer_mm / 2));
  const double high = options.last_mm.value_or(box.high.z - options.last_offset_mm.value_or(0));
  Planes planes;
  planes.distance = options.layer_mm;
  planes.first = low;
  // A last plane outside the range by rounding only belongs to it.
  const double count = std::floor((high - low) / options.layer_mm + 1e-9) + 1;
  geometry::require_count(count, "slice");
  planes.count = count > 0 ? static_cast<std::size_t>(count) : 0;
  return planes;
}

/// Twice the area inside, positive for counter-clockwise.
double doubled_area(std::span<const geometry::Point> v) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const geometry::Point &p = v[i], &q = v[(i + 1) % v.size()];
    sum += (p.x - v[0].x) * (q.y - v[0].y) - (q.x - v[0].x) * (p.y - v[0].y);
  }
  return sum;
}

/// The contour counter-clockwise from the vertex of largest x, for any first triangle of the chain.
std::vector<geometry::Point> normalised(const Contour& contour) {
  std::vector<geometry::Point> v = contour.vertices;
  if (!contour.closed) return v;
  if (doubled_area(v) < 0) std::reverse(v.begin(), v.end());
  const auto first =
      std::max_element(v.begin(), v.end(), [](const geometry::Point& p, const geometry::Point& q) {
        return p.x < q.x || (p.x == q.x && p.y < q.y);
      });
  std::rotate(v.begin(), first, v.end());
  v.push_back(v.front());
  return v;
}

/// Arc length from the first vertex to each.
std::vector<double> arc_lengths(std::span<const geometry::Point> v) {
  std::vector<double> length(v.size(), 0);
  for (std::size_t i = 1; i < v.size(); ++i) {
    length[i] = length[i - 1] + std::hypot(v[i].x - v[i - 1].x, v[i].y - v[i - 1].y);
  }
  return length;
}

/// Appends the points of `spread`, which must ascend along the polyline.
void sample(std::span<const geometry::Point> v, std::span<const double> length,
            const Spread& spread, geometry::PointCloud& cloud) {
  std::size_t piece = 0;
  for (std::size_t i = 0; i < spread.count; ++i) {
    const double s = spread.first_mm + static_cast<double>(i) * spread.distance_mm;
    while (piece + 2 < v.size() && length[piece + 1] < s) ++piece;
    const double span = length[piece + 1] - length[piece];
    const double t = span > 0 ? std::clamp((s - length[piece]) / span, 0.0, 1.0) : 0;
    const geometry::Point &p = v[piece], &q = v[piece + 1];
    cloud.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z});
  }
}

void sample_contour(const Contour& contour, double twist, const SliceOptions& options,
                    geometry::PointCloud& cloud) {
  const std::vector<geometry::Point> v = normalised(contour);
  const std::vector<double> length = arc_lengths(v);
  const Spread spread =
      spread_along(length.back(), {options.vertex_mm, contour.closed, twist, options.end_points},
                   cloud.size(), "slice");
  sample(v, length, spread, cloud);
}

}  // namespace

geometry::PointCloud slice(const model::Mesh& mesh, const SliceOptions& options) {
  return slice_in_layers(mesh, options).points;
}

LayeredPoints slice_in_layers(const model::Mesh& mesh, const SliceOptions& options) {
  check(options);
  LayeredPoints result;
  geometry::PointCloud& cloud = result.points;
  if (mesh.triangles.empty()) return result;
  const geometry::Affine frame = map_of(options.frame);
  model::Mesh turned;
  const model::Mesh& framed = in_frame(mesh, frame, turned);
  for_each_plane(framed, planes_for(framed, options),
                 [&](std::size_t k, std::span<const Contour> contours) {
                   const double twist = static_cast<double>(k) * options.twist_mm;
                   if (!contours.empty()) result.first.push_back(cloud.size());
                   for (const Contour& contour : contours) {
                     sample_contour(contour, twist, options, cloud);
                   }
                 });
  if (&framed == &mesh) return result;
  for (geometry::Point& point : cloud) point = frame(point);
  return result;
}

double height_across(const model::Mesh& mesh, const SliceFrame& frame) {
  model::Mesh turned;
  const geometry::Bounds box = bounds(in_frame(mesh, map_of(frame), turned).vertices);
  return box.high.z - box.low.z;
}

}  // namespace lamplock::points
