#include "host/points/face_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/geometry/vector.hpp"
#include "host/points/mesh_edges.hpp"

namespace lamplock::points {
namespace {

/// A vector along the normal with twice the area as its length.
geometry::Point area_vector(const model::Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return cross(difference(mesh.vertices[b], mesh.vertices[a]),
               difference(mesh.vertices[c], mesh.vertices[a]));
}

/// Triangles at each edge: those of edge i are triangles[first[i]] .. triangles[first[i + 1] - 1].
struct EdgeTriangles {
  MeshEdges edges;
  std::vector<std::uint32_t> first, triangles;

  explicit EdgeTriangles(const model::Mesh& mesh)
      : edges(number_edges(mesh)), first(edges.count + 1, 0), triangles(3 * mesh.triangles.size()) {
    for (const auto& of_triangle : edges.of_triangle)
      for (const std::uint32_t edge : of_triangle) ++first[edge + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < edges.of_triangle.size(); ++i)
      for (const std::uint32_t edge : edges.of_triangle[i]) triangles[next[edge]++] = i;
  }

  template <class Visit>
  void for_each_neighbour(std::uint32_t triangle, const Visit& visit) const {
    for (const std::uint32_t edge : edges.of_triangle[triangle])
      for (std::uint32_t i = first[edge]; i < first[edge + 1]; ++i) visit(triangles[i]);
  }
};

}  // namespace

std::vector<FacePatch> face_patches(const model::Mesh& mesh, const std::vector<bool>& usable,
                                    double max_angle_deg) {
  const EdgeTriangles neighbours(mesh);
  std::vector<geometry::Point> normals(mesh.triangles.size());
  std::vector<double> areas(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!usable[i]) continue;
    const geometry::Point vector = area_vector(mesh, i);
    areas[i] = norm(vector);
    normals[i] = times(vector, 1 / areas[i]);
    seeds.push_back(i);
  }
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return areas[i] > areas[j]; });
  const double min_cosine = std::cos(max_angle_deg * geometry::radians_per_degree);
  std::vector<bool> is_free = usable;
  std::vector<FacePatch> patches;
  for (const std::uint32_t seed : seeds) {
    if (!is_free[seed]) continue;
    FacePatch patch{seed};
    is_free[seed] = false;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      neighbours.for_each_neighbour(patch[i], [&](std::uint32_t next) {
        if (!is_free[next] || std::abs(dot(normals[next], normals[seed])) < min_cosine) return;
        is_free[next] = false;
        patch.push_back(next);
      });
    }
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace lamplock::points
