#include "host/model/join_seams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "host/geometry/bounds.hpp"
#include "host/geometry/kd_tree.hpp"
#include "host/geometry/vector.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

/// Two computations of one vertex in single precision differ by one or two of its last digits.
constexpr double max_rounding_steps = 4;

/// The vertices of edges that one triangle uses, or another odd number, in ascending order.
std::vector<std::uint32_t> vertices_of_open_edges(const Mesh& mesh) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t side = 0; side < 3; ++side) {
      const auto [low, high] = std::minmax(triangle[side], triangle[(side + 1) % 3]);
      edges.push_back(std::uint64_t{high} << 32U | low);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> vertices;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    if ((end - begin) % 2 == 0) continue;
    vertices.push_back(static_cast<std::uint32_t>(edges[begin]));
    vertices.push_back(static_cast<std::uint32_t>(edges[begin] >> 32U));
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// For each vertex the one that it becomes: the first within the tolerance that keeps its place.
/// Not a chain: no vertex moves by more than the tolerance.
std::vector<std::uint32_t> joined(const Mesh& mesh, const std::vector<std::uint32_t>& open,
                                  double tolerance) {
  using Cell = std::array<double, 3>;
  const auto cell_of = [&](const Point& p) {
    return Cell{std::floor(p.x / tolerance), std::floor(p.y / tolerance),
                std::floor(p.z / tolerance)};
  };
  std::vector<std::uint32_t> becomes(mesh.vertices.size());
  std::iota(becomes.begin(), becomes.end(), 0U);
  std::map<Cell, std::vector<std::uint32_t>> cells;  // of vertices that keep their place
  const auto find = [&](const Point& p, const Cell& centre) {
    for (int i = 0; i < 27; ++i) {
      const auto near =
          cells.find({centre[0] + i % 3 - 1, centre[1] + i / 3 % 3 - 1, centre[2] + i / 9 - 1});
      if (near == cells.end()) continue;
      for (const std::uint32_t other : near->second)
        if (norm(difference(mesh.vertices[other], p)) <= tolerance) return other;
    }
    return std::numeric_limits<std::uint32_t>::max();
  };
  for (const std::uint32_t vertex : open) {
    const Point& p = mesh.vertices[vertex];
    const Cell cell = cell_of(p);
    const std::uint32_t other = find(p, cell);
    if (other != std::numeric_limits<std::uint32_t>::max())
      becomes[vertex] = other;
    else
      cells[cell].push_back(vertex);
  }
  return becomes;
}

}  // namespace

std::size_t join_seams(Mesh& mesh, std::vector<std::uint32_t>& kept) {
  const std::vector<std::uint32_t> open = vertices_of_open_edges(mesh);
  if (open.empty()) return 0;
  const double size = geometry::bounds(mesh.vertices).max_side();
  const double tolerance =
      max_rounding_steps * double{std::numeric_limits<float>::epsilon()} * size;
  if (!(tolerance > 0) || !std::isfinite(tolerance)) return 0;
  const std::vector<std::uint32_t> becomes = joined(mesh, open, tolerance);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < becomes.size(); ++i) count += becomes[i] != i ? 1U : 0U;
  const auto keeps_its_corners = [&](const auto& triangle) {
    const std::array corners{becomes[triangle[0]], becomes[triangle[1]], becomes[triangle[2]]};
    return corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  };
  // Where all triangles are smaller than the rounding they are no seams.
  if (count == 0 || std::none_of(mesh.triangles.begin(), mesh.triangles.end(), keeps_its_corners))
    return 0;
  std::size_t left = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    auto triangle = mesh.triangles[i];
    if (!keeps_its_corners(triangle)) continue;
    for (std::uint32_t& vertex : triangle) vertex = becomes[vertex];
    mesh.triangles[left] = triangle;
    kept[left++] = kept[i];
  }
  mesh.triangles.resize(left);
  kept.resize(left);
  return count;
}

double widest_gap_mm(const Mesh& mesh) {
  const std::vector<std::uint32_t> open = vertices_of_open_edges(mesh);
  if (open.size() < 2) return 0;
  geometry::PointCloud cloud;
  for (const std::uint32_t vertex : open) cloud.push_back(mesh.vertices[vertex]);
  const auto tree = geometry::kd_tree_of(cloud);
  double greatest = 0;
  for (const Point& point : cloud) {
    std::array<std::uint32_t, 2> number{};
    std::array<double, 2> squared{};  // of the point itself, of the next one
    tree.nearest(point, squared.size(), number, squared);
    greatest = std::max(greatest, squared[1]);
  }
  return std::sqrt(greatest);
}

}  // namespace lamplock::model
