#include "host/points/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "host/geometry/bounds.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/mesh_parts.hpp"

namespace lamplock::points {
namespace {

using geometry::Bounds;
using geometry::Point;

/// A closed part of the mesh.
struct Part {
  std::vector<Triangle> triangles{};
  bool has_winding = true;  ///< each edge is used equally often in both directions
  double volume_mm3 = 0;    ///< negative: normals point inwards
  Bounds box{};
};

Triangle sorted(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

/// True if the corners are an even permutation of their order by number.
bool is_even(const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return (a < b && b < c) || (b < c && c < a) || (c < a && a < b);
}

bool is_balanced(std::span<const Triangle> triangles) {
  const std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
  bool balanced = true;
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    const auto forward =
        std::count_if(edge.begin(), edge.end(), [](const EdgeUse& use) { return use.forward; });
    balanced = balanced && 2 * static_cast<std::size_t>(forward) == edge.size();
  });
  return balanced;
}

/// True if every triangle is there equally often in both orientations.
bool cancels(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, bool>> all;
  all.reserve(triangles.size());
  for (const Triangle& triangle : triangles) all.emplace_back(sorted(triangle), is_even(triangle));
  std::sort(all.begin(), all.end());
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    std::ptrdiff_t even = 0;
    for (; end < all.size() && all[end].first == all[begin].first; ++end)
      even += all[end].second ? 1 : -1;
    if (even != 0) return false;
  }
  return true;
}

/// Six times the volume between the triangles and a point near them.
double volume_of(const model::Mesh& mesh, std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0;
  const Point& from = mesh.vertices[triangles.front()[0]];
  double volume = 0;
  for (const auto& [a, b, c] : triangles) {
    volume += dot(difference(mesh.vertices[a], from),
                  cross(difference(mesh.vertices[b], from), difference(mesh.vertices[c], from)));
  }
  return volume / 6;
}

Bounds box_of(const model::Mesh& mesh, std::span<const Triangle> triangles) {
  const Point& first = mesh.vertices[triangles.front()[0]];
  Bounds box{first, first};
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      const Point& p = mesh.vertices[corner];
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
  }
  return box;
}

bool is_strictly_in(const Bounds& inner, const Bounds& outer) {
  return inner.low.x > outer.low.x && inner.low.y > outer.low.y && inner.low.z > outer.low.z &&
         inner.high.x < outer.high.x && inner.high.y < outer.high.y && inner.high.z < outer.high.z;
}

/// All parts, with a winding number where that is possible.
std::vector<Part> closed_parts(const model::Mesh& mesh) {
  const MeshParts numbers = parts_of(mesh.triangles);
  std::vector<Part> parts(numbers.count);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    parts[numbers.of_triangle[i]].triangles.push_back(mesh.triangles[i]);
  for (Part& part : parts) {
    if (!is_balanced(part.triangles) || cancels(part.triangles)) {
      std::vector<Triangle> single = without_duplicates(part.triangles);
      orient_alike(single);
      part.has_winding = is_balanced(single);
      if (part.has_winding) part.triangles = std::move(single);
    }
    part.volume_mm3 = volume_of(mesh, part.triangles);
    part.box = box_of(mesh, part.triangles);
  }
  return parts;
}

/// Finds the parts that contain others.
class Nesting {
 public:
  Nesting(const model::Mesh& mesh, const std::vector<Part>& parts)
      : mesh_(mesh),
        parts_(parts),
        triangles_(all_triangles(parts)),
        crossings_(mesh.vertices, triangles_) {
    for (std::uint32_t i = 0; i < parts.size(); ++i)
      part_of_.insert(part_of_.end(), parts[i].triangles.size(), i);
  }

  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  /// The smallest part that wholly contains part `inner`, or none.
  std::size_t parent_of(std::size_t inner) const {
    std::vector<std::size_t> around;
    bool first = true;
    for (const Triangle& triangle : parts_[inner].triangles) {
      for (const std::uint32_t corner : triangle) {
        std::vector<std::size_t> here = around_vertex(inner, mesh_.vertices[corner]);
        if (!first)
          std::erase_if(here, [&](std::size_t i) {
            return !std::binary_search(around.begin(), around.end(), i);
          });
        around = std::move(here);
        if (around.empty()) return none;
        first = false;
      }
    }
    return *std::min_element(around.begin(), around.end(), [&](std::size_t i, std::size_t j) {
      return std::abs(parts_[i].volume_mm3) < std::abs(parts_[j].volume_mm3);
    });
  }

 private:
  static std::vector<Triangle> all_triangles(const std::vector<Part>& parts) {
    std::vector<Triangle> all;
    for (const Part& part : parts)
      all.insert(all.end(), part.triangles.begin(), part.triangles.end());
    return all;
  }

  /// Parts round a vertex of part `inner`, in ascending order.
  std::vector<std::size_t> around_vertex(std::size_t inner, const Point& vertex) const {
    std::vector<std::pair<std::size_t, int>> passed;  // part, direction of crossing
    crossings_.for_each_above(vertex, [&](const Crossing& crossing) {
      const std::size_t part = part_of_[crossing.triangle];
      if (parts_[part].has_winding && is_strictly_in(parts_[inner].box, parts_[part].box))
        passed.emplace_back(part, crossing.normal_up ? 1 : -1);
    });
    std::sort(passed.begin(), passed.end());
    std::vector<std::size_t> around;
    for (std::size_t begin = 0, end = 0; begin < passed.size(); begin = end) {
      int winding = 0;
      for (; end < passed.size() && passed[end].first == passed[begin].first; ++end)
        winding += passed[end].second;
      if (winding != 0) around.push_back(passed[begin].first);
    }
    return around;
  }

  const model::Mesh& mesh_;
  const std::vector<Part>& parts_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> part_of_;  // of each triangle
  VerticalCrossings crossings_;
};

void turn(Part& part) {
  for (Triangle& triangle : part.triangles) std::swap(triangle[1], triangle[2]);
  part.volume_mm3 = -part.volume_mm3;
}

/// Turns parts that are inside out, each with the parts in it.
void turn_outwards(const model::Mesh& mesh, std::vector<Part>& parts) {
  const auto is_inward = [](const Part& part) { return part.has_winding && part.volume_mm3 < 0; };
  if (std::none_of(parts.begin(), parts.end(), is_inward)) return;
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // A part has more volume than those in it.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return std::abs(parts[i].volume_mm3) > std::abs(parts[j].volume_mm3);
  });
  const Nesting nesting(mesh, parts);
  std::vector<bool> turned(parts.size(), false);
  for (const std::size_t i : order) {
    if (!parts[i].has_winding) continue;
    const std::size_t parent = nesting.parent_of(i);
    turned[i] = parent == Nesting::none ? parts[i].volume_mm3 < 0 : turned[parent];
  }
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (turned[i]) turn(parts[i]);
}

}  // namespace

Bodies bodies_of(const model::Mesh& mesh) {
  std::vector<Part> parts = closed_parts(mesh);
  turn_outwards(mesh, parts);
  Bodies bodies;
  for (const Part& part : parts) {
    std::vector<Triangle>& triangles = part.has_winding ? bodies.oriented : bodies.others;
    triangles.insert(triangles.end(), part.triangles.begin(), part.triangles.end());
    bodies.volume_mm3 += part.has_winding ? part.volume_mm3 : std::abs(part.volume_mm3);
  }
  return bodies;
}

}  // namespace lamplock::points
