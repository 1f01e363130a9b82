#include "host/points/poisson_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/geometry/parallel.hpp"
#include "host/geometry/vector.hpp"

namespace lamplock::points {
namespace {

/// Added to the wanted distance, so that rounding never makes it less.
constexpr double block_rounding = 1e-12;

/// Distance, in units of the wanted one, by which a point may lie in the cell beside its own: a
/// place at the border of a block belongs to that block in spite of rounding.
constexpr double rounded_into_next_cell = 1e-6;

/// A radius as float must not be less than the distance.
float rounded_up(double radius) {
  return std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::infinity());
}

geometry::Point moved(const geometry::Point& point, double by) {
  return {point.x + by, point.y + by, point.z + by};
}

unsigned group_of(const BlockIndex& block) {
  return static_cast<unsigned>((block.x & 1) | (block.y & 1) << 1 | (block.z & 1) << 2);
}

/// A dart with `other` as radius is too near to one with `radius` at `place`.
bool is_too_near(const geometry::Point& place, double radius, const geometry::Point& point,
                 double other) {
  const double apart = std::min(radius, other) * (1 + block_rounding);
  return square_of_distance(place, point) < apart * apart;
}

/// A dart covers the triangle.
bool covers(const geometry::Point& point, double other, const Corners& triangle, double radius) {
  const double apart = std::min(radius, other), square = apart * apart;
  return square_of_distance(triangle[0], point) < square &&
         square_of_distance(triangle[1], point) < square &&
         square_of_distance(triangle[2], point) < square;
}

/// A dart covers the cube with this centre and half of this side.
bool covers(const geometry::Point& point, double other, const geometry::Point& centre, double half,
            double radius) {
  const double apart = std::min(radius, other);
  // To the furthest corner.
  const double x = std::abs(point.x - centre.x) + half, y = std::abs(point.y - centre.y) + half,
               z = std::abs(point.z - centre.z) + half;
  return x * x + y * y + z * z < apart * apart;
}

/// From a point to the nearest point of a box.
double square_to_box(const geometry::Point& p, const geometry::Bounds& box) {
  const double x = std::max({box.low.x - p.x, p.x - box.high.x, 0.0}),
               y = std::max({box.low.y - p.y, p.y - box.high.y, 0.0}),
               z = std::max({box.low.z - p.z, p.z - box.high.z, 0.0});
  return x * x + y * y + z * z;
}

}  // namespace

bool NearDarts::is_covered(const Corners& triangle, double radius) const {
  return std::any_of(darts_.begin(), darts_.end(), [&](const NearDart& dart) {
    return covers(dart.place, dart.radius, triangle, radius);
  });
}

bool NearDarts::is_covered(const geometry::Point& low, double side_mm, double radius) const {
  const double half = side_mm / 2;
  const geometry::Point centre = moved(low, half);
  return std::any_of(darts_.begin(), darts_.end(), [&](const NearDart& dart) {
    return covers(dart.place, dart.radius, centre, half, radius);
  });
}

DartBlocks::DartBlocks(const BlockGrid& grid, std::vector<BlockIndex> blocks, double distance_mm)
    : grid_(grid), blocks_(std::move(blocks)), distance_(distance_mm), contents_(blocks_.size()) {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    groups_[group_of(blocks_[i])].push_back(static_cast<std::uint32_t>(i));
  }
}

void DartBlocks::for_each(unsigned threads,
                          const std::function<void(std::size_t, BlockDarts&)>& work) {
  for (const auto& group : groups_) {
    geometry::for_each_index(group.size(), threads, [&](std::size_t i) {
      BlockDarts darts(*this, group[i]);
      work(group[i], darts);
    });
  }
}

std::size_t DartBlocks::count() const {
  std::size_t points = 0;
  for (const Block& block : contents_) points += block.points.size();
  return points;
}

geometry::PointCloud DartBlocks::take() {
  geometry::PointCloud cloud;
  cloud.reserve(count());
  for (Block& block : contents_) {
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (block.radii.empty() || block.radii[i] > 0) cloud.push_back(block.points[i]);
    }
    block = {};
  }
  return cloud;
}

BlockDarts::BlockDarts(DartBlocks& all, std::size_t block)
    : all_(all),
      low_(all.box(block).low),
      cells_per_mm_(DartBlocks::cells / (block_distances * all.distance_)) {
  const BlockIndex& index = all.blocks_[block];
  for (int i = 0; i < 27; ++i) {
    const BlockIndex wanted{index.x + i % 3 - 1, index.y + i / 3 % 3 - 1, index.z + i / 9 - 1};
    const auto found = std::lower_bound(all.blocks_.begin(), all.blocks_.end(), wanted);
    if (found == all.blocks_.end() || *found != wanted) continue;
    around_[static_cast<std::size_t>(i)] =
        &all.contents_[static_cast<std::size_t>(found - all.blocks_.begin())];
  }
}

/// Counted from the lowest cell of the lowest of the 27 blocks.
BlockDarts::Cells BlockDarts::cells_at(const geometry::Point& place) const {
  constexpr double n = DartBlocks::cells;
  const auto cell = [&](double coordinate, double from) {
    const double rank = (coordinate - from) * cells_per_mm_ + n;
    return static_cast<unsigned>(std::clamp(rank, 0.0, 3 * n - 1));
  };
  return {cell(place.x, low_.x), cell(place.y, low_.y), cell(place.z, low_.z)};
}

double BlockDarts::radius_of(const DartBlocks::Block& block, std::size_t point) const {
  return block.radii.empty() ? all_.distance_ : std::abs(static_cast<double>(block.radii[point]));
}

/// True if `found(place, radius)` is true for any dart in the cells of a box.
template <class Found>
bool BlockDarts::any_within(const geometry::Point& low, const geometry::Point& high,
                            const Found& found) const {
  const Cells from = cells_at(low), to = cells_at(high);
  constexpr unsigned n = DartBlocks::cells;
  for (unsigned z = from[2]; z <= to[2]; ++z) {
    for (unsigned y = from[1]; y <= to[1]; ++y) {
      for (unsigned x = from[0]; x <= to[0]; ++x) {
        const auto* block = around_[x / n + 3 * (y / n) + 9 * (z / n)];
        if (block == nullptr) continue;
        const unsigned cell = x % n + n * (y % n + n * (z % n));
        for (std::size_t i = block->heads[cell]; i != DartBlocks::none; i = block->next[i]) {
          if (found(block->points[i], radius_of(*block, i))) return true;
        }
      }
    }
  }
  return false;
}

bool BlockDarts::is_free(const geometry::Point& place, double radius) const {
  const double reach = radius + rounded_into_next_cell * all_.distance_;
  return !any_within(moved(place, -reach), moved(place, reach),
                     [&](const geometry::Point& point, double other) {
                       return is_too_near(place, radius, point, other);
                     });
}

bool BlockDarts::is_covered(const Corners& triangle, double radius) const {
  // A dart that covers every corner is within its radius of the outermost ones.
  const double reach = radius + rounded_into_next_cell * all_.distance_;
  const geometry::Point &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const geometry::Point low{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}),
                            std::max({a.z, b.z, c.z})};
  const geometry::Point high{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                             std::min({a.z, b.z, c.z})};
  return any_within(moved(low, -reach), moved(high, reach),
                    [&](const geometry::Point& point, double other) {
                      return covers(point, other, triangle, radius);
                    });
}

bool BlockDarts::is_covered(const geometry::Point& low, double side_mm, double radius) const {
  const double reach = radius + rounded_into_next_cell * all_.distance_;
  const double half = side_mm / 2;
  const geometry::Point centre = moved(low, half);
  return any_within(moved(low, side_mm - reach), moved(low, reach),
                    [&](const geometry::Point& point, double other) {
                      return covers(point, other, centre, half, radius);
                    });
}

void BlockDarts::find_near(const geometry::Bounds& box, double radius, NearDarts& near) const {
  near.clear();
  const double reach = radius + rounded_into_next_cell * all_.distance_;
  any_within(moved(box.low, -reach), moved(box.high, reach),
             [&](const geometry::Point& point, double other) {
               if (square_to_box(point, box) < reach * reach) near.add(point, other);
               return false;
             });
}

void BlockDarts::add(const Dart& dart) {
  DartBlocks::Block& block = *around_[13];
  const bool plain = dart.visible && dart.radius_mm == all_.distance_;
  if (!plain && block.radii.empty()) {
    block.radii.assign(block.points.size(), rounded_up(all_.distance_));
  }
  if (!plain || !block.radii.empty()) {
    const float radius = rounded_up(dart.radius_mm);
    block.radii.push_back(dart.visible ? radius : -radius);
  }
  constexpr unsigned n = DartBlocks::cells;
  const Cells cells = cells_at(dart.place);
  const auto inside = [](unsigned cell) {
    return std::clamp(cell, DartBlocks::cells, 2 * DartBlocks::cells - 1) - DartBlocks::cells;
  };
  const unsigned cell = inside(cells[0]) + n * (inside(cells[1]) + n * inside(cells[2]));
  block.next.push_back(block.heads[cell]);
  block.heads[cell] = static_cast<std::uint16_t>(block.points.size());
  block.points.push_back(dart.place);
}

}  // namespace lamplock::points
