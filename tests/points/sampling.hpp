// Measurements for tests of the discretisers: distances of a cloud, random places of a surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "host/model/mesh.hpp"
#include "tests/points/shapes.hpp"

namespace lamplock::test {

/// Square of the smallest distance of two points, by comparing all that are near along x.
inline double min_square(geometry::PointCloud cloud) {
  std::sort(cloud.begin(), cloud.end(), [](auto& p, auto& q) { return p.x < q.x; });
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = i + 1; j < cloud.size(); ++j) {
      const double x = cloud[i].x - cloud[j].x, y = cloud[i].y - cloud[j].y,
                   z = cloud[i].z - cloud[j].z;
      if (x * x >= smallest) break;
      smallest = std::min(smallest, x * x + y * y + z * z);
    }
  }
  return smallest;
}

inline double nearest_distance(const geometry::Point& place, const geometry::PointCloud& cloud) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& point : cloud) nearest = std::min(nearest, distance(place, point));
  return nearest;
}

inline std::array<geometry::Point, 3> corners(const model::Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

inline double area(const model::Mesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = corners(mesh, triangle);
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
}

inline double area(const model::Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) sum += area(mesh, i);
  return sum;
}

/// Uniformly distributed places on the surface.
inline geometry::PointCloud random_places(const model::Mesh& mesh, int count,
                                          std::mt19937_64& random) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) areas.push_back(area(mesh, i));
  std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
  std::uniform_real_distribution<double> part(0, 1);
  geometry::PointCloud places;
  for (int i = 0; i < count; ++i) {
    const auto [a, b, c] = corners(mesh, triangle(random));
    const double root = std::sqrt(part(random)), v = part(random) * root, u = root - v;
    places.push_back({a.x + u * (b.x - a.x) + v * (c.x - a.x),
                      a.y + u * (b.y - a.y) + v * (c.y - a.y),
                      a.z + u * (b.z - a.z) + v * (c.z - a.z)});
  }
  return places;
}

/// A flat rectangle at z = 0 of nx * ny cells of two triangles, from (x, y) up.
inline void add_plate(model::Mesh& mesh, double x, double y, double wide, double high,
                      std::uint32_t nx, std::uint32_t ny) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) {
      mesh.vertices.push_back({x + wide * i / nx, y + high * j / ny, 0});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + j * (nx + 1) + i; };
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

/// Gives all corners of each triangle the brightness at its middle.
template <class Light>
void set_brightness(model::Mesh& mesh, const Light& light) {
  mesh.brightness.emplace();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners(mesh, i);
    const auto value = static_cast<float>(light((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3));
    mesh.brightness->corners.push_back({value, value, value});
  }
}

}  // namespace lamplock::test
