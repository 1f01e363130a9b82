#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/geometry/limits.hpp"
#include "host/geometry/parallel.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/shells.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {
namespace {

constexpr geometry::Point down{0, 0, -1};

geometry::Point normal_of(const Corners& t) {
  const geometry::Point u = difference(t[1], t[0]), v = difference(t[2], t[0]);
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

double square_to_segment(const geometry::Point& place, const geometry::Point& from,
                         const geometry::Point& to) {
  const geometry::Point way = difference(to, from), there = difference(place, from);
  const double length = dot(way, way);
  const double t = length > 0 ? std::clamp(dot(there, way) / length, 0.0, 1.0) : 0;
  const geometry::Point rest{there.x - t * way.x, there.y - t * way.y, there.z - t * way.z};
  return dot(rest, rest);
}

/// Square of the distance from a place to a triangle.
double square_to(const geometry::Point& place, const Corners& t, const geometry::Point& normal) {
  const double length = dot(normal, normal);
  bool over = length > 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const geometry::Point& from = t[i];
    const geometry::Point& to = t[(i + 1) % 3];
    over = over && dot(normal_of({from, to, place}), normal) >= 0;
    nearest = std::min(nearest, square_to_segment(place, from, to));
  }
  if (!over) return nearest;
  const double height = dot(difference(place, t[0]), normal);
  return height * height / length;
}

/// Blocks of about the size of a few triangles, and at least the reach of a search.
double block_side(const model::Mesh& mesh, const geometry::Bounds& box, double reach_mm) {
  constexpr double triangles_wide = 4, max_in_a_row = 4096;
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) area += area_of(corners_of(mesh, i));
  const double triangle = std::sqrt(area / static_cast<double>(mesh.triangles.size()));
  return std::max({2 * reach_mm, triangles_wide * triangle, box.max_side() / max_in_a_row});
}

/// Searches the blocks within reach of a place.
class NearestTriangle {
 public:
  NearestTriangle(const model::Mesh& mesh, double reach_mm)
      : mesh_(mesh), reach_(reach_mm), box_(bounds(mesh.vertices)) {
    const BlockGrid grid = grid_over(box_, block_side(mesh, box_, reach_mm), "shells");
    blocks_ = surface_blocks(mesh, grid, "shells");
  }

  geometry::Point inward_at(const geometry::Point& place) const {
    if (!is_near(place)) return down;
    const BlockIndex low = blocks_.grid.of({place.x - reach_, place.y - reach_, place.z - reach_});
    const BlockIndex high = blocks_.grid.of({place.x + reach_, place.y + reach_, place.z + reach_});
    double nearest = reach_ * reach_;
    geometry::Point inward = down;
    for (BlockIndex i = low; i.x <= high.x; ++i.x) {
      for (i.y = low.y; i.y <= high.y; ++i.y) {
        for (i.z = low.z; i.z <= high.z; ++i.z) search(i, place, nearest, inward);
      }
    }
    return inward;
  }

 private:
  bool is_near(const geometry::Point& place) const {
    const auto near = [this](double at, double low, double high) {
      return at >= low - reach_ && at <= high + reach_;
    };
    return near(place.x, box_.low.x, box_.high.x) && near(place.y, box_.low.y, box_.high.y) &&
           near(place.z, box_.low.z, box_.high.z);
  }

  void search(const BlockIndex& block, const geometry::Point& place, double& nearest,
              geometry::Point& inward) const {
    const auto found = std::lower_bound(blocks_.blocks.begin(), blocks_.blocks.end(), block);
    if (found == blocks_.blocks.end() || *found != block) return;
    for (const std::uint32_t i :
         blocks_.of(static_cast<std::size_t>(found - blocks_.blocks.begin()))) {
      const Corners corners = corners_of(mesh_, i);
      const geometry::Point normal = normal_of(corners);
      const double square = square_to(place, corners, normal);
      if (!(square < nearest)) continue;
      nearest = square;
      const double length = -std::sqrt(dot(normal, normal));
      inward = {normal.x / length, normal.y / length, normal.z / length};
    }
  }

  const model::Mesh& mesh_;
  double reach_;
  geometry::Bounds box_;
  SurfaceBlocks blocks_;
};

}  // namespace

std::vector<geometry::Point> inward_ways(const model::Mesh& mesh,
                                         std::span<const geometry::Point> cloud, double reach_mm) {
  geometry::require_positive(reach_mm, "shells", "reach");
  require_sound(mesh, "shells");
  std::vector<geometry::Point> ways(cloud.size(), down);
  if (mesh.triangles.empty()) return ways;
  const NearestTriangle nearest(mesh, reach_mm);
  geometry::for_each_index(cloud.size(), 0,
                           [&](std::size_t i) { ways[i] = nearest.inward_at(cloud[i]); });
  return ways;
}

}  // namespace lamplock::points
