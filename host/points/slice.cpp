#include "host/points/slice.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "host/points/bounds.hpp"
#include "host/points/contours.hpp"
#include "host/points/limits.hpp"

namespace lamplock::points {
namespace {

Planes planes_for(const model::Mesh& mesh, const SliceOptions& options) {
  const Bounds box = bounds(mesh.vertices);
  Planes planes;
  planes.distance = options.layer_mm;
  planes.first = options.first_mm.value_or(box.low.z + options.layer_mm / 2);
  const double last = options.last_mm.value_or(box.high.z);
  // A last plane that is missed by rounding alone belongs to the range.
  const double count = std::floor((last - planes.first) / options.layer_mm + 1e-9) + 1;
  require_count(count, "slice");
  planes.count = count > 0 ? static_cast<std::size_t>(count) : 0;
  return planes;
}

/// Twice the area inside, positive for counter-clockwise.
double doubled_area(std::span<const Point> v) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Point &p = v[i], &q = v[(i + 1) % v.size()];
    sum += (p.x - v[0].x) * (q.y - v[0].y) - (q.x - v[0].x) * (p.y - v[0].y);
  }
  return sum;
}

/// Counter-clockwise from the vertex of largest x, whatever triangle the chain began with.
std::vector<Point> normalised(const Contour& contour) {
  std::vector<Point> v = contour.vertices;
  if (!contour.closed) return v;
  if (doubled_area(v) < 0) std::reverse(v.begin(), v.end());
  const auto first = std::max_element(v.begin(), v.end(), [](const Point& p, const Point& q) {
    return p.x < q.x || (p.x == q.x && p.y < q.y);
  });
  std::rotate(v.begin(), first, v.end());
  v.push_back(v.front());
  return v;
}

/// Arc length from the first vertex to each.
std::vector<double> arc_lengths(std::span<const Point> v) {
  std::vector<double> length(v.size(), 0);
  for (std::size_t i = 1; i < v.size(); ++i) {
    length[i] = length[i - 1] + std::hypot(v[i].x - v[i - 1].x, v[i].y - v[i - 1].y);
  }
  return length;
}

/// Appends `count` points at arc lengths first + i * distance, which must rise along the polyline.
void sample(std::span<const Point> v, std::span<const double> length, double first, double distance,
            std::size_t count, PointCloud& cloud) {
  std::size_t piece = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = first + static_cast<double>(i) * distance;
    while (piece + 2 < v.size() && length[piece + 1] < s) ++piece;
    const double span = length[piece + 1] - length[piece];
    const double t = span > 0 ? std::clamp((s - length[piece]) / span, 0.0, 1.0) : 0;
    const Point &p = v[piece], &q = v[piece + 1];
    cloud.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z});
  }
}

void sample_contour(const Contour& contour, double twist, const SliceOptions& options,
                    PointCloud& cloud) {
  const std::vector<Point> v = normalised(contour);
  const std::vector<double> length = arc_lengths(v);
  const double total = length.back();
  const double pieces = std::max(1.0, std::floor(total / options.vertex_mm));
  require_count(static_cast<double>(cloud.size()) + pieces, "slice");
  const auto count = static_cast<std::size_t>(pieces);
  const double distance = total / pieces;
  if (contour.closed) {
    const double offset = distance > 0 ? std::fmod(twist, distance) : 0;
    sample(v, length, offset < 0 ? offset + distance : offset, distance, count, cloud);
  } else if (options.end_points) {
    sample(v, length, 0, distance, count + 1, cloud);
  } else {
    sample(v, length, distance / 2, distance, count, cloud);
  }
}

}  // namespace

PointCloud slice(const model::Mesh& mesh, const SliceOptions& options) {
  require_positive(options.layer_mm, "slice", "layer distance");
  require_positive(options.vertex_mm, "slice", "vertex distance");
  PointCloud cloud;
  if (mesh.triangles.empty()) return cloud;
  for_each_plane(mesh, planes_for(mesh, options),
                 [&](std::size_t k, std::span<const Contour> contours) {
                   const double twist = static_cast<double>(k) * options.twist_mm;
                   for (const Contour& contour : contours) {
                     sample_contour(contour, twist, options, cloud);
                   }
                 });
  return cloud;
}

}  // namespace lamplock::points
