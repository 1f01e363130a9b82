// Generates small inputs of each kind.
#pragma once

#include <fmt/format.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::cli::test {

/// An octahedron of 2 x 2 x 2, ASCII STL.
inline std::string octahedron_stl() {
  std::string text = "solid octahedron\n";
  for (const int x : {1, -1})
    for (const int y : {1, -1})
      for (const int z : {1, -1}) {
        text += "facet normal 0 0 0\nouter loop\n";
        text += fmt::format("vertex {} 0 0\n", x);
        // The normal points outward in every octant.
        const std::string second = fmt::format("vertex 0 {} 0\n", y);
        const std::string third = fmt::format("vertex 0 0 {}\n", z);
        text += x * y * z > 0 ? second + third : third + second;
        text += "endloop\nendfacet\n";
      }
  return text + "endsolid octahedron\n";
}

/// A black disc on white, 24-bit BMP.
inline std::string disc_bmp(int size) {
  const int row = (size * 3 + 3) / 4 * 4;
  const int data = row * size;
  std::string bytes = "BM";
  const auto put = [&bytes](int value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  };
  put(54 + data, 4), put(0, 4), put(54, 4);
  put(40, 4), put(size, 4), put(size, 4), put(1, 2), put(24, 2);
  put(0, 4), put(data, 4), put(2835, 4), put(2835, 4), put(0, 4), put(0, 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
      put(dx * dx + dy * dy < size * size ? 0 : 0xffffff, 3);
    }
    put(0, row - 3 * size);
  }
  return bytes;
}

/// A walk through a cube of 4 mm, at coordinates between steps.
inline std::vector<geometry::Point> walk(int count, std::uint64_t seed, double stride_mm = 0.2) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> stride(-stride_mm, stride_mm);
  std::vector<geometry::Point> points;
  std::array<double, 3> at{};
  for (int i = 0; i < count; ++i) {
    for (double& x : at) {
      const double next = x + stride(random);
      x = next < -2 || next > 2 ? x : next;
    }
    points.push_back({at[0], at[1], at[2]});
  }
  return points;
}

inline std::string xyz(const std::vector<geometry::Point>& points) {
  std::string text;
  for (const geometry::Point& p : points) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  return text;
}

}  // namespace lamplock::cli::test
