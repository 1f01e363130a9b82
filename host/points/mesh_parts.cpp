#include "host/points/mesh_parts.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "host/geometry/union_find.hpp"

namespace lamplock::points {
namespace {

/// Joins the sets that use an edge an odd number of times; a single one is joined with another.
void join_odd(std::span<const EdgeUse> uses, geometry::UnionFind& sets) {
  std::vector<std::uint32_t> users, odd;
  users.reserve(uses.size());
  for (const EdgeUse& use : uses) users.push_back(sets.find(use.triangle));
  std::sort(users.begin(), users.end());
  for (std::size_t begin = 0, end = 0; begin < users.size(); begin = end) {
    while (end < users.size() && users[end] == users[begin]) ++end;
    if ((end - begin) % 2 != 0) odd.push_back(users[begin]);
  }
  if (odd.size() == 1) odd.push_back(users.front() == odd.front() ? users.back() : users.front());
  for (std::size_t i = 1; i < odd.size(); ++i) sets.join(odd[0], odd[i]);
}

/// For each triangle the index of the first one with the same three vertices.
std::vector<std::uint32_t> first_equals(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, std::uint32_t>> order;
  order.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    order.emplace_back(triangles[i], i);
    std::sort(order.back().first.begin(), order.back().first.end());
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> firsts(triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_first = i == 0 || order[i].first != order[i - 1].first;
    firsts[order[i].second] = is_first ? order[i].second : firsts[order[i - 1].second];
  }
  return firsts;
}

}  // namespace

std::vector<Triangle> without_duplicates(const std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> firsts = first_equals(triangles);
  std::vector<Triangle> single;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (firsts[i] == i) single.push_back(triangles[i]);
  return single;
}

std::vector<EdgeUse> sorted_edge_uses(std::span<const Triangle> triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t from = triangles[i][side], to = triangles[i][(side + 1) % 3];
      if (from == to) continue;
      uses.push_back(
          {std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(i), from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& p, const EdgeUse& q) {
    return std::tie(p.low, p.high, p.triangle) < std::tie(q.low, q.high, q.triangle);
  });
  return uses;
}

MeshParts parts_of(const std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> firsts = first_equals(triangles);
  std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
  std::erase_if(uses, [&](const EdgeUse& use) { return firsts[use.triangle] != use.triangle; });
  geometry::UnionFind sets(triangles.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() == 2) sets.join(edge[0].triangle, edge[1].triangle);
  });
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() > 2) join_odd(edge, sets);
  });
  MeshParts parts;
  parts.of_triangle.resize(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t first = sets.find(firsts[i]);
    parts.of_triangle[i] =
        first == i ? static_cast<std::uint32_t>(parts.count++) : parts.of_triangle[first];
  }
  return parts;
}

void orient_alike(std::vector<Triangle>& triangles) {
  struct Neighbour {
    std::uint32_t from, to;
    bool alike;  // both have the same orientation now
  };
  std::vector<Neighbour> neighbours;
  const std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2) return;
    const bool alike = edge[0].forward != edge[1].forward;
    neighbours.push_back({edge[0].triangle, edge[1].triangle, alike});
    neighbours.push_back({edge[1].triangle, edge[0].triangle, alike});
  });
  std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& p, const Neighbour& q) {
    return std::tie(p.from, p.to) < std::tie(q.from, q.to);
  });
  enum class State : std::uint8_t { unknown, kept, turned };
  std::vector<State> states(triangles.size(), State::unknown);
  std::vector<std::uint32_t> open;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (states[seed] != State::unknown) continue;
    states[seed] = State::kept;
    open.push_back(seed);
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      auto next = std::lower_bound(
          neighbours.begin(), neighbours.end(), from,
          [](const Neighbour& neighbour, std::uint32_t i) { return neighbour.from < i; });
      for (; next != neighbours.end() && next->from == from; ++next) {
        if (states[next->to] != State::unknown) continue;
        const bool turned = (states[from] == State::turned) == next->alike;
        states[next->to] = turned ? State::turned : State::kept;
        open.push_back(next->to);
      }
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (states[i] == State::turned) std::swap(triangles[i][1], triangles[i][2]);
}

}  // namespace lamplock::points
