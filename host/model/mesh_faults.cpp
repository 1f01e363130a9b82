#include "host/model/mesh_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>

#include "host/geometry/vector.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

/// One use of an edge by a triangle.
struct EdgeUse {
  std::uint32_t low = 0, high = 0, triangle = 0;
  bool forward = false;  // from low to high
  friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

bool names_vertices(const Mesh& mesh, std::size_t triangle) {
  return std::all_of(mesh.triangles[triangle].begin(), mesh.triangles[triangle].end(),
                     [&](std::uint32_t corner) { return corner < mesh.vertices.size(); });
}

void note(MeshFault& fault, std::size_t triangle, const Point& from, const Point& to) {
  if (fault.count == 0 || triangle < fault.triangle) {
    fault.triangle = triangle;
    fault.from = from;
    fault.to = to;
  }
  ++fault.count;
}

/// Six times the volume between the triangle and the origin, positive if the normal points away.
double volume_under(const Point& a, const Point& b, const Point& c) {
  return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
         a.z * (b.x * c.y - b.y * c.x);
}

bool is_flat(const Point& a, const Point& b, const Point& c) {
  const Point u = difference(b, a), v = difference(c, a);
  return u.y * v.z == u.z * v.y && u.z * v.x == u.x * v.z && u.x * v.y == u.y * v.x;
}

std::vector<EdgeUse> sorted_edges(const Mesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!names_vertices(mesh, i)) continue;
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t from = mesh.triangles[i][side], to = mesh.triangles[i][(side + 1) % 3];
      if (from == to) continue;
      uses.push_back(
          {std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(i), from < to});
    }
  }
  std::sort(uses.begin(), uses.end());
  return uses;
}

/// Checks all uses of one edge.
void judge_edge(const Mesh& mesh, std::span<const EdgeUse> uses, MeshFaults& faults) {
  const EdgeUse& first = uses.front();
  MeshFault* fault = nullptr;
  if (uses.size() == 1) {
    fault = &faults.open_edges;
  } else if (uses.size() > 2) {
    fault = &faults.non_manifold_edges;
  } else if (uses[0].forward == uses[1].forward) {
    fault = &faults.turned_edges;
  }
  if (uses.size() % 2 != 0) faults.closed = false;
  if (fault == nullptr) return;
  note(*fault, first.triangle, mesh.vertices[first.low], mesh.vertices[first.high]);
}

void judge_edges(const Mesh& mesh, MeshFaults& faults) {
  const std::vector<EdgeUse> uses = sorted_edges(mesh);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low &&
           uses[end].high == uses[begin].high) {
      ++end;
    }
    judge_edge(mesh, std::span(uses).subspan(begin, end - begin), faults);
  }
}

void judge_triangles(const Mesh& mesh, MeshFaults& faults) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!names_vertices(mesh, i)) {
      note(faults.missing_vertices, i, {}, {});
      continue;
    }
    const auto& [j, k, l] = mesh.triangles[i];
    const Point &a = mesh.vertices[j], &b = mesh.vertices[k], &c = mesh.vertices[l];
    if (is_flat(a, b, c)) note(faults.flat_triangles, i, a, a);
    // Relative to a vertex: the origin may be far away.
    const Point& origin = mesh.vertices.front();
    volume += volume_under(difference(a, origin), difference(b, origin), difference(c, origin));
  }
  faults.inside_out = faults.closed && faults.turned_edges.count == 0 &&
                      faults.non_manifold_edges.count == 0 && volume < 0;
}

std::string text_of(const Point& p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

std::string edge_text(const MeshFault& fault, std::string_view edge, std::string_view edges) {
  return fmt::format("{}, the first at triangle {} from {} to {}",
                     count_text(fault.count, edge, edges), fault.triangle, text_of(fault.from),
                     text_of(fault.to));
}

}  // namespace

bool MeshFaults::none() const {
  return open_edges.count + non_manifold_edges.count + turned_edges.count + flat_triangles.count +
                 not_finite_vertices.count + missing_vertices.count ==
             0 &&
         !inside_out;
}

MeshFaults find_faults(const Mesh& mesh) {
  MeshFaults faults;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Point& vertex = mesh.vertices[i];
    if (!geometry::is_finite(vertex)) note(faults.not_finite_vertices, i, vertex, vertex);
  }
  faults.closed = !mesh.triangles.empty();
  judge_edges(mesh, faults);
  judge_triangles(mesh, faults);
  if (faults.missing_vertices.count > 0) faults.closed = false;
  return faults;
}

std::vector<std::string> warnings(const MeshFaults& faults) {
  std::vector<std::string> lines;
  const auto say = [&](const MeshFault& fault, const std::string& line) {
    if (fault.count > 0) lines.push_back(line);
  };
  say(faults.open_edges, edge_text(faults.open_edges, "open edge", "open edges"));
  say(faults.non_manifold_edges,
      edge_text(faults.non_manifold_edges, "edge of more than two triangles",
                "edges of more than two triangles"));
  say(faults.turned_edges,
      edge_text(faults.turned_edges, "edge between triangles of opposite orientation",
                "edges between triangles of opposite orientation"));
  say(faults.flat_triangles,
      fmt::format("{} without area, the first is {} at {}",
                  count_text(faults.flat_triangles.count, "triangle"),
                  faults.flat_triangles.triangle, text_of(faults.flat_triangles.from)));
  say(faults.not_finite_vertices,
      fmt::format("{} not finite, the first is {} at {}",
                  count_text(faults.not_finite_vertices.count, "vertex is", "vertices are"),
                  faults.not_finite_vertices.triangle, text_of(faults.not_finite_vertices.from)));
  say(faults.missing_vertices,
      fmt::format("{} vertices that do not exist, the first is {}",
                  count_text(faults.missing_vertices.count, "triangle names", "triangles name"),
                  faults.missing_vertices.triangle));
  if (faults.inside_out) lines.emplace_back("the surface is inside out: its normals point inwards");
  return lines;
}

}  // namespace lamplock::model
