#include "host/points/rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "host/geometry/bounds.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::points {
namespace {

/// A mesh coordinate by axis number.
double coordinate(const geometry::Point& point, std::size_t axis) {
  return axis == 0 ? point.x : axis == 1 ? point.y : point.z;
}

/// Rays along one of the two directions of the grid: at `first + i * pitch`, i < count.
struct Rank {
  double first = 0;
  std::int64_t count = 0;
};

Rank rank_for(double low, double high, double pitch) {
  // With more rays in a row, edge products would not fit into 64 bits.
  constexpr double max_rays = 1 << 20;
  const double count = std::max(1.0, std::floor((high - low) / pitch));
  geometry::require_count(count * static_cast<double>(geometry::max_points) / max_rays, "rays");
  return {low + (high - low - (count - 1) * pitch) / 2, static_cast<std::int64_t>(count)};
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - ((a % b != 0 && (a < 0) != (b < 0)) ? 1 : 0);
}

struct LatticePoint {
  std::int64_t u = 0, v = 0;
  double depth = 0;
};

/// Side of (u, v) at the edge from p to q: positive to the left.
std::int64_t edge_side(const LatticePoint& p, const LatticePoint& q, std::int64_t u,
                       std::int64_t v) {
  return (q.u - p.u) * (v - p.v) - (q.v - p.v) * (u - p.u);
}

/// Rasterises triangles into the grid of rays.
class RayGrid {
 public:
  RayGrid(const model::Mesh& mesh, const RayOptions& options)
      : pitch_(options.pitch_mm),
        depth_axis_(static_cast<std::size_t>(options.direction)),
        u_axis_((depth_axis_ + 1) % 3),
        v_axis_((depth_axis_ + 2) % 3) {
    const geometry::Bounds box = bounds(mesh.vertices);
    u_ = rank_for(coordinate(box.low, u_axis_), coordinate(box.high, u_axis_), pitch_);
    v_ = rank_for(coordinate(box.low, v_axis_), coordinate(box.high, v_axis_), pitch_);
    // Lattice coordinates stay below 2^29: differences below 2^30, edge products below 2^61.
    const auto most = static_cast<double>(std::max(u_.count, v_.count) + 2);
    shift_ = std::clamp(static_cast<int>(std::floor(29 - std::log2(most))), 0, 20);
    cell_ = std::int64_t{1} << shift_;
  }

  /// Area of a triangle in cells of the grid: about as many rays hit it.
  double cells_of(const geometry::Point& a, const geometry::Point& b,
                  const geometry::Point& c) const {
    const LatticePoint p = lattice(a), q = lattice(b), r = lattice(c);
    const auto twice = static_cast<double>(std::abs(edge_side(p, q, r.u, r.v)));
    return twice / 2 / static_cast<double>(cell_) / static_cast<double>(cell_);
  }

  /// Adds the places where rays hit a triangle.
  void add(const geometry::Point& a, const geometry::Point& b, const geometry::Point& c,
           geometry::PointCloud& cloud) const {
    std::array<LatticePoint, 3> t{lattice(a), lattice(b), lattice(c)};
    const std::int64_t area = edge_side(t[0], t[1], t[2].u, t[2].v);
    if (area == 0) return;
    if (area < 0) std::swap(t[1], t[2]);
    const auto [low, high] = std::minmax({t[0].v, t[1].v, t[2].v});
    const std::int64_t first = std::max<std::int64_t>(0, floor_div(low + cell_ - 1, cell_));
    const std::int64_t last = std::min(v_.count - 1, floor_div(high, cell_));
    for (std::int64_t row = first; row <= last; ++row) add_row(t, row, cloud);
  }

 private:
  LatticePoint lattice(const geometry::Point& point) const {
    const auto scale = static_cast<double>(cell_) / pitch_;
    return {std::llround((coordinate(point, u_axis_) - u_.first) * scale),
            std::llround((coordinate(point, v_axis_) - v_.first) * scale),
            coordinate(point, depth_axis_)};
  }

  /// Narrows the rays first..last of a row to those inside the edge p -> q of a counter-clockwise
  /// triangle. A ray on the edge belongs to it if the edge is a left or a top one (top-left rule:
  /// the ray counts as shifted a little to the right and, by less, downwards).
  void clip(const LatticePoint& p, const LatticePoint& q, std::int64_t v, std::int64_t& first,
            std::int64_t& last) const {
    const std::int64_t du = q.u - p.u, dv = q.v - p.v;
    const std::int64_t at_zero = du * (v - p.v) + dv * p.u;  // the side at u = 0, grows by -dv
    if (dv < 0) {                                            // left edge: -dv * u >= -at_zero
      first = std::max(first, floor_div(-at_zero + (-dv) * cell_ - 1, -dv * cell_));
    } else if (dv > 0) {  // right edge: dv * u < at_zero
      last = std::min(last, floor_div(at_zero - 1, dv * cell_));
    } else if (at_zero < 0 || (at_zero == 0 && du > 0)) {  // level: the upper one (du < 0) counts
      last = first - 1;
    }
  }

  void add_row(const std::array<LatticePoint, 3>& t, std::int64_t row,
               geometry::PointCloud& cloud) const {
    const std::int64_t v = row * cell_;
    std::int64_t first = 0, last = u_.count - 1;
    for (std::size_t i = 0; i < 3 && first <= last; ++i) clip(t[i], t[(i + 1) % 3], v, first, last);
    if (first > last) return;
    geometry::require_count(static_cast<double>(cloud.size()) + static_cast<double>(last - first),
                            "rays");
    const auto area = static_cast<double>(edge_side(t[0], t[1], t[2].u, t[2].v));
    for (std::int64_t column = first; column <= last; ++column) {
      const std::int64_t u = column * cell_;
      const double b = static_cast<double>(edge_side(t[2], t[0], u, v)) / area;
      const double c = static_cast<double>(edge_side(t[0], t[1], u, v)) / area;
      const double depth =
          t[0].depth + b * (t[1].depth - t[0].depth) + c * (t[2].depth - t[0].depth);
      cloud.push_back(point(column, row, depth));
    }
  }

  geometry::Point point(std::int64_t column, std::int64_t row, double depth) const {
    std::array<double, 3> position{};
    position[u_axis_] = u_.first + static_cast<double>(column) * pitch_;
    position[v_axis_] = v_.first + static_cast<double>(row) * pitch_;
    position[depth_axis_] = depth;
    return {position[0], position[1], position[2]};
  }

  double pitch_;
  std::size_t depth_axis_, u_axis_, v_axis_;
  Rank u_, v_;
  int shift_ = 0;
  std::int64_t cell_ = 1;  // lattice units per pitch
};

}  // namespace

geometry::PointCloud rays(const model::Mesh& mesh, const RayOptions& options) {
  geometry::require_positive(options.pitch_mm, "rays", "pitch");
  geometry::PointCloud cloud;
  if (mesh.triangles.empty()) return cloud;
  const RayGrid grid(mesh, options);
  const auto for_each_triangle = [&](const auto& work) {
    for (const auto& [a, b, c] : mesh.triangles)
      work(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  };
  // Far too many are refused before millions are computed; add() counts those near the limit.
  constexpr double surely = 0.9;
  double cells = 0;
  for_each_triangle([&](const auto&... corners) { cells += grid.cells_of(corners...); });
  geometry::require_count(surely * cells, "rays");
  for_each_triangle([&](const auto&... corners) { grid.add(corners..., cloud); });
  return cloud;
}

}  // namespace lamplock::points
