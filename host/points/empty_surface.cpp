#include "host/points/empty_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/point_grid.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {
namespace {

constexpr std::size_t places = 20'000;

geometry::Point random_place_on(const Corners& corners, geometry::Random& random) {
  const double root = std::sqrt(random.uniform());
  const double c = root * random.uniform(), b = root - c;
  const geometry::Point u = difference(corners[1], corners[0]);
  const geometry::Point v = difference(corners[2], corners[0]);
  return {corners[0].x + b * u.x + c * v.x, corners[0].y + b * u.y + c * v.y,
          corners[0].z + b * u.z + c * v.z};
}

}  // namespace

double empty_share(const model::Mesh& mesh, std::span<const geometry::Point> cloud,
                   double reach_mm) {
  geometry::require_positive(reach_mm, "empty surface", "reach");
  geometry::require_count(static_cast<double>(cloud.size()), "empty surface");
  std::vector<double> areas;  // of all triangles up to each
  areas.reserve(mesh.triangles.size());
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    areas.push_back(area += area_of(corners_of(mesh, i)));
  if (!(area > 0)) return 0;
  PointGrid grid(cloud.size(), reach_mm);
  for (std::size_t i = 0; i < cloud.size(); ++i) grid.add(static_cast<std::uint32_t>(i), cloud[i]);
  geometry::Random random(1);
  std::size_t empty = 0;
  for (std::size_t i = 0; i < places; ++i) {
    const double at = area * (static_cast<double>(i) + random.uniform()) / places;
    const auto found = std::upper_bound(areas.begin(), areas.end() - 1, at);
    const auto triangle = static_cast<std::size_t>(found - areas.begin());
    const geometry::Point place = random_place_on(corners_of(mesh, triangle), random);
    const bool is_near = grid.any_near(place, [&](std::uint32_t k) {
      return square_of_distance(cloud[k], place) < reach_mm * reach_mm;
    });
    if (!is_near) ++empty;
  }
  return static_cast<double>(empty) / places;
}

}  // namespace lamplock::points
