#include "host/points/surface_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/number_text.hpp"

namespace lamplock::points {
namespace {

constexpr std::array<double geometry::Point::*, 3> axes{&geometry::Point::x, &geometry::Point::y,
                                                        &geometry::Point::z};
constexpr std::array<std::int32_t BlockIndex::*, 3> ranks{&BlockIndex::x, &BlockIndex::y,
                                                          &BlockIndex::z};

/// A convex polygon. A triangle cut by the six planes of a box has at most nine corners; rounding
/// may add some, for which there is room, and even more are dropped.
struct Polygon {
  std::array<geometry::Point, 16> corners;
  std::size_t count = 0;

  explicit Polygon(const Corners& triangle) : corners{}, count(3) {
    std::copy(triangle.begin(), triangle.end(), corners.begin());
  }
  Polygon() : corners{} {}
  void add(const geometry::Point& corner) {
    if (count < corners.size()) corners[count++] = corner;
  }
  std::span<const geometry::Point> all() const { return std::span(corners).first(count); }
};

/// The point where the edge crosses the plane; exactly on the plane.
geometry::Point crossing(const geometry::Point& p, const geometry::Point& q,
                         double geometry::Point::*axis, double plane) {
  const double t = (plane - p.*axis) / (q.*axis - p.*axis);
  geometry::Point cut{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)};
  cut.*axis = plane;
  return cut;
}

/// The part on one side of a plane, its border included.
Polygon clipped(const Polygon& polygon, double geometry::Point::*axis, double plane, bool above) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const geometry::Point& p = polygon.corners[i];
    const geometry::Point& q = polygon.corners[(i + 1) % polygon.count];
    const double from = above ? p.*axis - plane : plane - p.*axis;
    const double to = above ? q.*axis - plane : plane - q.*axis;
    if (from >= 0) part.add(p);
    if ((from > 0 && to < 0) || (from < 0 && to > 0)) part.add(crossing(p, q, axis, plane));
  }
  return part;
}

struct Entry {
  BlockIndex block;
  std::uint32_t triangle = 0;
  friend auto operator<=>(const Entry&, const Entry&) = default;
};

/// Finds the blocks of one triangle after the other.
class BlockSpreader {
 public:
  BlockSpreader(const BlockGrid& grid, std::string where) : grid_(grid), where_(std::move(where)) {}

  void add(std::uint32_t triangle, const Corners& corners) {
    triangle_ = triangle;
    const geometry::Bounds box = bounds(corners);
    halve(Polygon(corners), grid_.of(box.low), grid_.of(box.high));
  }

  std::vector<Entry>& entries() { return entries_; }

 private:
  /// `low` to `high`: the blocks in which the polygon may lie.
  void halve(const Polygon& polygon, const BlockIndex& low, const BlockIndex& high) {
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (high.*ranks[i] - low.*ranks[i] > high.*ranks[longest] - low.*ranks[longest]) longest = i;
    }
    const auto rank = ranks[longest];
    if (high.*rank == low.*rank) {
      geometry::require_count(static_cast<double>(entries_.size()), where_);
      entries_.push_back({low, triangle_});
      return;
    }
    const std::int32_t middle = low.*rank + (high.*rank - low.*rank + 1) / 2;
    const auto axis = axes[longest];
    const double plane = grid_.origin.*axis + middle * grid_.side_mm;
    BlockIndex below = high, above = low;
    below.*rank = middle - 1;
    above.*rank = middle;
    const auto is_under = [&](const geometry::Point& corner) { return corner.*axis < plane; };
    const auto all = polygon.all();
    if (std::none_of(all.begin(), all.end(), is_under)) {
      halve(polygon, above, high);
    } else if (std::all_of(all.begin(), all.end(),
                           [&](const geometry::Point& corner) { return corner.*axis <= plane; })) {
      halve(polygon, low, below);
    } else {
      halve(clipped(polygon, axis, plane, false), low, below);
      halve(clipped(polygon, axis, plane, true), above, high);
    }
  }

  const BlockGrid& grid_;
  std::string where_;
  std::uint32_t triangle_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace

BlockIndex BlockGrid::of(const geometry::Point& point) const {
  // A quotient rounds differently from the planes of box(), but both must agree.
  const auto rank = [this](double coordinate, double from) {
    double k = std::floor((coordinate - from) / side_mm);
    while (from + k * side_mm > coordinate) --k;
    while (from + (k + 1) * side_mm <= coordinate) ++k;
    return static_cast<std::int32_t>(k);
  };
  return {rank(point.x, origin.x), rank(point.y, origin.y), rank(point.z, origin.z)};
}

geometry::Bounds BlockGrid::box(const BlockIndex& block) const {
  return {
      {origin.x + block.x * side_mm, origin.y + block.y * side_mm, origin.z + block.z * side_mm},
      {origin.x + (block.x + 1) * side_mm, origin.y + (block.y + 1) * side_mm,
       origin.z + (block.z + 1) * side_mm}};
}

BlockGrid grid_over(const geometry::Bounds& box, double side_mm, const std::string& where) {
  constexpr double max_in_a_row = 1 << 20;
  if (!(box.max_side() / side_mm < max_in_a_row)) {
    throw Error(Exit::bad_input, where,
                fmt::format("a size of {:.3g} mm is too large for this spacing", box.max_side()),
                "use a larger spacing or a smaller size");
  }
  // Further from the origin doubles are too coarse: here they have steps of 2e-9 of a side, and the
  // search for gaps allows for rounding by 6e-8 of it.
  constexpr double max_sides_away = 1e7;
  double furthest = 0;
  for (const geometry::Point& corner : {box.low, box.high})
    furthest = std::max({furthest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  if (!(furthest / side_mm < max_sides_away)) {
    throw Error(Exit::bad_input, where,
                fmt::format("a point {:.3g} mm from the origin is too far away", furthest),
                "move it nearer");
  }
  return {box.low, side_mm};
}

SurfaceBlocks surface_blocks(const model::Mesh& mesh, const BlockGrid& grid,
                             const std::string& where) {
  BlockSpreader spreader(grid, where);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners corners = corners_of(mesh, i);
    if (area_of(corners) > 0) spreader.add(static_cast<std::uint32_t>(i), corners);
  }
  std::vector<Entry>& entries = spreader.entries();
  std::sort(entries.begin(), entries.end());
  SurfaceBlocks result{grid, {}, {}, {}};
  result.triangles.reserve(entries.size());
  for (const Entry& entry : entries) {
    if (result.blocks.empty() || result.blocks.back() != entry.block) {
      result.blocks.push_back(entry.block);
      result.first.push_back(result.triangles.size());
    }
    result.triangles.push_back(entry.triangle);
  }
  result.first.push_back(result.triangles.size());
  return result;
}

void cut_to_box(const Corners& triangle, const geometry::Bounds& box,
                std::vector<Corners>& pieces) {
  if (std::all_of(triangle.begin(), triangle.end(),
                  [&](const geometry::Point& corner) { return box.contains(corner); })) {
    if (area_of(triangle) > 0) pieces.push_back(triangle);
    return;
  }
  Polygon polygon(triangle);
  for (const auto axis : axes) {
    const auto all = polygon.all();
    const auto [low, high] = std::minmax_element(
        all.begin(), all.end(),
        [&](const geometry::Point& p, const geometry::Point& q) { return p.*axis < q.*axis; });
    if (low == all.end()) return;
    const bool cut_low = *low.*axis<box.low.*axis, cut_high = *high.*axis> box.high.*axis;
    if (cut_low) polygon = clipped(polygon, axis, box.low.*axis, true);
    if (cut_high) polygon = clipped(polygon, axis, box.high.*axis, false);
  }
  for (std::size_t i = 2; i < polygon.count; ++i) {
    const Corners piece{polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]};
    if (area_of(piece) > 0) pieces.push_back(piece);
  }
}

void require_sound(const model::Mesh& mesh, const std::string& where) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const geometry::Point& p = mesh.vertices[i];
    if (geometry::is_finite(p)) continue;
    throw Error(Exit::bad_input, where,
                fmt::format("vertex {} has a coordinate that is not finite: ({}, {}, {})", i, p.x,
                            p.y, p.z),
                "repair the model");
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner < mesh.vertices.size()) continue;
      throw Error(Exit::bad_input, where,
                  fmt::format("triangle {} refers to vertex {}, but the model has {}", i, corner,
                              count_text(mesh.vertices.size(), "vertex", "vertices")),
                  "repair the model");
    }
  }
}

Corners corners_of(const model::Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

double area_of(const Corners& triangle) {
  const auto& [a, b, c] = triangle;
  const geometry::Point u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
  const geometry::Point n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  return std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z) / 2;
}

}  // namespace lamplock::points
