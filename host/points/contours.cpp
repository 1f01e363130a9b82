#include "host/points/contours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "host/geometry/limits.hpp"
#include "host/geometry/union_find.hpp"
#include "host/points/mesh_edges.hpp"

namespace lamplock::points {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The cut of one triangle: from edge to edge.
struct Cut {
  std::array<std::uint32_t, 2> edge;
  std::array<geometry::Point, 2> at;
};

/// Both triangles of an edge must get the same point, so the lower vertex number is first.
geometry::Point on_edge(const model::Mesh& mesh, std::uint32_t a, std::uint32_t b, double z) {
  const geometry::Point& p = mesh.vertices[std::min(a, b)];
  const geometry::Point& q = mesh.vertices[std::max(a, b)];
  const double t = (z - p.z) / (q.z - p.z);
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), z};
}

/// Calls `visit(a, b)` for each side of each triangle.
template <class Visit>
void for_each_side(const model::Mesh& mesh, const Visit& visit) {
  for (const auto& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side) visit(t[side], t[(side + 1) % 3]);
}

/// For each vertex the number of planes below it: it counts as above a plane through it, but as
/// below one that touches the mesh there from below.
std::vector<std::size_t> levels_of(const model::Mesh& mesh, const Planes& planes) {
  const std::vector<geometry::Point>& at = mesh.vertices;
  std::vector<std::size_t> level(at.size());
  std::vector<bool> is_on_plane(at.size());
  for (std::size_t v = 0; v < level.size(); ++v) {
    level[v] = planes.not_above(at[v].z);
    is_on_plane[v] = level[v] > 0 && planes.z(level[v] - 1) == at[v].z;
  }
  if (std::find(is_on_plane.begin(), is_on_plane.end(), true) == is_on_plane.end()) return level;
  // Sides in a plane make flat places of their ends. The lowest ones have no side that descends.
  geometry::UnionFind places(at.size());
  for_each_side(mesh, [&](std::uint32_t a, std::uint32_t b) {
    if (is_on_plane[a] && at[a].z == at[b].z) places.join(a, b);
  });
  std::vector<bool> descends(at.size()), ascends(at.size());
  for_each_side(mesh, [&](std::uint32_t a, std::uint32_t b) {
    if (at[a].z == at[b].z) return;
    const bool falls = at[b].z < at[a].z;
    (falls ? descends : ascends)[places.find(a)] = true;
    (falls ? ascends : descends)[places.find(b)] = true;
  });
  for (std::uint32_t v = 0; v < at.size(); ++v) {
    const std::uint32_t place = places.find(v);
    if (is_on_plane[v] && ascends[place] && !descends[place]) --level[v];
  }
  return level;
}

/// Triangles that each plane cuts: those of plane k are list[start[k]] .. list[start[k+1]-1].
struct Crossings {
  std::vector<std::size_t> start;
  std::vector<std::uint32_t> list;
};

Crossings find_crossings(const model::Mesh& mesh, const std::vector<std::size_t>& level,
                         std::size_t planes) {
  const auto range = [&](const std::array<std::uint32_t, 3>& t) {
    return std::minmax({level[t[0]], level[t[1]], level[t[2]]});
  };
  Crossings crossings;
  crossings.start.assign(planes + 1, 0);
  double total = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [low, high] = range(triangle);
    total += static_cast<double>(high - low);
  }
  // A cut needs four bytes, a sixth of a point; a fine mesh has more cuts than points.
  geometry::require_count(total / 4, "slice");
  for (const auto& triangle : mesh.triangles) {
    const auto [low, high] = range(triangle);
    for (std::size_t k = low; k < high; ++k) ++crossings.start[k + 1];
  }
  for (std::size_t k = 0; k < planes; ++k) crossings.start[k + 1] += crossings.start[k];
  crossings.list.resize(crossings.start.back());
  std::vector<std::size_t> next(crossings.start.begin(), crossings.start.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [low, high] = range(mesh.triangles[t]);
    for (std::size_t k = low; k < high; ++k) crossings.list[next[k]++] = t;
  }
  return crossings;
}

/// Chains the cuts of one plane after the other; its tables have an entry per edge of the mesh, and
/// only used entries are reset after every plane.
class Chainer {
 public:
  explicit Chainer(std::size_t edges) : head_(edges, none) {}

  std::vector<Contour> chain(const std::vector<Cut>& cuts) {
    next_.assign(2 * cuts.size(), none);
    used_.assign(cuts.size(), false);
    for (std::uint32_t end = 0; end < next_.size(); ++end) {
      std::uint32_t& head = head_[cuts[end / 2].edge[end % 2]];
      next_[end] = head;
      head = end;
    }
    std::vector<Contour> contours;
    for (std::uint32_t cut = 0; cut < cuts.size(); ++cut) {
      if (!used_[cut]) contours.push_back(contour_through(cuts, cut));
    }
    for (const Cut& cut : cuts) head_[cut.edge[0]] = head_[cut.edge[1]] = none;
    return contours;
  }

 private:
  Contour contour_through(const std::vector<Cut>& cuts, std::uint32_t first) {
    used_[first] = true;
    Contour contour;
    contour.vertices = {cuts[first].at[0], cuts[first].at[1]};
    const std::uint32_t start_edge = cuts[first].edge[0];
    contour.closed = extend(cuts, cuts[first].edge[1], start_edge, contour.vertices);
    if (contour.closed) {
      contour.vertices.pop_back();
    } else {
      std::reverse(contour.vertices.begin(), contour.vertices.end());
      extend(cuts, start_edge, none, contour.vertices);
    }
    return contour;
  }

  /// Appends cuts from `edge` on until none follows; true when `goal` was reached.
  bool extend(const std::vector<Cut>& cuts, std::uint32_t edge, std::uint32_t goal,
              std::vector<geometry::Point>& vertices) {
    while (edge != goal) {
      std::uint32_t end = head_[edge];
      while (end != none && used_[end / 2]) end = next_[end];
      if (end == none) return false;
      used_[end / 2] = true;
      edge = cuts[end / 2].edge[1 - end % 2];
      vertices.push_back(cuts[end / 2].at[1 - end % 2]);
    }
    return true;
  }

  std::vector<std::uint32_t> head_, next_;  // ends of cuts on each edge, linked
  std::vector<bool> used_;
};

}  // namespace

std::size_t Planes::not_above(double height) const {
  const double guess = std::floor((height - first) / distance) + 1;
  auto k = static_cast<std::size_t>(std::clamp(guess, 0.0, static_cast<double>(count)));
  while (k > 0 && z(k - 1) > height) --k;
  while (k < count && z(k) <= height) ++k;
  return k;
}

void for_each_plane(const model::Mesh& mesh, const Planes& planes,
                    const std::function<void(std::size_t, std::span<const Contour>)>& visit) {
  const std::vector<std::size_t> level = levels_of(mesh, planes);
  const MeshEdges edges = number_edges(mesh);
  const Crossings crossings = find_crossings(mesh, level, planes.count);
  Chainer chainer(edges.count);
  std::vector<Cut> cuts;
  for (std::size_t k = 0; k < planes.count; ++k) {
    cuts.clear();
    for (std::size_t i = crossings.start[k]; i < crossings.start[k + 1]; ++i) {
      const std::uint32_t t = crossings.list[i];
      Cut cut{};
      std::size_t ends = 0;
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t a = mesh.triangles[t][side], b = mesh.triangles[t][(side + 1) % 3];
        if ((level[a] > k) == (level[b] > k)) continue;
        cut.edge[ends] = edges.of_triangle[t][side];
        cut.at[ends++] = on_edge(mesh, a, b, planes.z(k));
      }
      cuts.push_back(cut);
    }
    visit(k, chainer.chain(cuts));
  }
}

}  // namespace lamplock::points
