#include "host/points/mesh_edges.hpp"

#include <algorithm>
#include <unordered_map>

namespace lamplock::points {

MeshEdges number_edges(const model::Mesh& mesh) {
  struct Hash {
    std::size_t operator()(std::uint64_t key) const {
      return static_cast<std::size_t>((key ^ (key >> 32)) * 0x9E3779B97F4A7C15u);
    }
  };
  std::unordered_map<std::uint64_t, std::uint32_t, Hash> numbers;
  numbers.reserve(mesh.triangles.size() * 2);  // a closed mesh has 3/2 edges a triangle
  MeshEdges edges;
  edges.of_triangle.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    auto& row = edges.of_triangle.emplace_back();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto [low, high] = std::minmax(triangle[corner], triangle[(corner + 1) % 3]);
      const std::uint64_t key = static_cast<std::uint64_t>(high) << 32 | low;
      row[corner] =
          numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    }
  }
  edges.count = numbers.size();
  return edges;
}

}  // namespace lamplock::points
