// Bodies with known geometry, for the tests of this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "host/model/mesh.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test {

/// A torus round z, major radius `ring`, minor radius r, closed, outward normals. The offset
/// rotates the mesh slightly so that no vertex is on a special line by accident.
inline model::Mesh torus(double ring, double r, std::uint32_t around, std::uint32_t along,
                         double offset = 0) {
  using std::numbers::pi;
  model::Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < along; ++j) {
      const double a = 2 * pi * i / around + offset, b = 2 * pi * j / along + offset;
      const double d = ring + r * std::cos(b);
      mesh.vertices.push_back({d * std::cos(a), d * std::sin(a), r * std::sin(b)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * along + j % along; };
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < along; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A sphere with `rings` rings between two poles on z.
inline model::Mesh sphere(double radius, std::uint32_t rings, std::uint32_t around) {
  using std::numbers::pi;
  model::Mesh mesh;
  mesh.vertices.push_back({0, 0, -radius});
  for (std::uint32_t i = 1; i <= rings; ++i) {
    const double b = pi * i / (rings + 1);
    for (std::uint32_t k = 0; k < around; ++k) {
      const double a = 2 * pi * k / around;
      mesh.vertices.push_back({radius * std::sin(b) * std::cos(a),
                               radius * std::sin(b) * std::sin(a), -radius * std::cos(b)});
    }
  }
  mesh.vertices.push_back({0, 0, radius});
  const auto top = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return 1 + i * around + k % around; };
  for (std::uint32_t k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), top});
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  }
  return mesh;
}

/// A box of two triangles a side with corners at +-half.
inline model::Mesh box(double x, double y, double z) {
  model::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1) != 0 ? x : -x, (i & 2) != 0 ? y : -y, (i & 4) != 0 ? z : -z});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Whether every edge is used once in each direction: closed and consistently oriented.
inline bool is_closed(const model::Mesh& mesh) {
  // An edge as one number, its vertices in the upper and the lower half.
  std::vector<std::uint64_t> edges, opposite;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t from = t[i], to = t[(i + 1) % 3];
      edges.push_back(from << 32 | to);
      opposite.push_back(to << 32 | from);
    }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return !edges.empty() && edges == opposite &&
         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/// 0 .. count - 1.
inline std::uint32_t below(std::mt19937_64& random, std::uint32_t count) {
  return static_cast<std::uint32_t>(random() % count);
}

inline geometry::PointCloud random_cloud(std::mt19937_64& random, std::size_t count, double half) {
  std::uniform_real_distribution<double> coordinate(-half, half);
  geometry::PointCloud cloud(count);
  for (auto& p : cloud) p = {coordinate(random), coordinate(random), coordinate(random)};
  return cloud;
}

inline double distance(const geometry::Point& p, const geometry::Point& q) {
  return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

}  // namespace lamplock::test
