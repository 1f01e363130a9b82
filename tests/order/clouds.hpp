// Clouds that are difficult to order, for the tests of this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "host/geometry/point.hpp"
#include "tests/points/shapes.hpp"

namespace lamplock::test {

/// Random points in a cube of 2 mm, without a smallest distance; by `kind` also on a lattice with
/// many equal points, in columns, in planes, all at one place, one above the other, all on a line.
inline constexpr int cloud_kinds = 7;
inline geometry::PointCloud awkward_cloud(std::mt19937_64& random, int kind, std::size_t count) {
  geometry::PointCloud cloud = random_cloud(random, count, 1);
  const auto rounded = [](double value, double to) { return std::round(value / to) * to; };
  for (geometry::Point& p : cloud) {
    if (kind == 1) p = {rounded(p.x, 0.2), rounded(p.y, 0.2), rounded(p.z, 0.2)};
    if (kind == 2) p = {rounded(p.x, 0.5), rounded(p.y, 0.5), p.z};
    if (kind == 3) p.z = rounded(p.z, 0.25);
    if (kind == 4) p = {1, 2, 3};
    if (kind == 5) p = {1, 2, p.z};
    if (kind == 6) p = {p.x, p.x, p.x};
  }
  return cloud;
}

inline bool is_permutation_of(geometry::PointCloud a, geometry::PointCloud b) {
  const auto less = [](const geometry::Point& p, const geometry::Point& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::sort(a.begin(), a.end(), less);
  std::sort(b.begin(), b.end(), less);
  return a == b;
}

}  // namespace lamplock::test
