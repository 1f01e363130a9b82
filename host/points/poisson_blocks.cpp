#include "host/points/poisson_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/geometry/parallel.hpp"

namespace lamplock::points {
namespace {

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

/// From a point to the nearest point of a box.
double square_to_box(const geometry::Point& p, const geometry::Bounds& box) {
  const auto beside = [](double at, double low, double high) {
    return std::max(std::max(low - at, at - high), 0.0);
  };
  const double x = beside(p.x, box.low.x, box.high.x), y = beside(p.y, box.low.y, box.high.y),
               z = beside(p.z, box.low.z, box.high.z);
  return x * x + y * y + z * z;
}

}  // namespace

DartBlocks::DartBlocks(const BlockGrid& grid, std::vector<BlockIndex> blocks, double distance_mm)
    : grid_(grid),
      blocks_(std::move(blocks)),
      distance_(distance_mm),
      rounded_distance_(rounded_up(distance_mm)),
      contents_(blocks_.size()) {
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
      block_(all.contents_[block]),
      box_(all.box(block)),
      units_{box_.low, 1 / all.distance_},
      cells_per_mm_(1 / (cell_distances * all.distance_)),
      rounding_mm_(rounded_into_next_cell * all.distance_) {
  heads_.fill(-1);
  for (std::size_t i = 0; i < block_.points.size(); ++i)
    enter(block_.points[i],
          block_.radii.empty() ? all_.rounded_distance_ : std::abs(block_.radii[i]));
  const BlockIndex& own = all.blocks_[block];
  for (int column = 0; column < 9; ++column) {
    const BlockIndex low{own.x + column / 3 - 1, own.y + column % 3 - 1, own.z - 1};
    const BlockIndex high{low.x, low.y, own.z + 1};
    auto found = std::lower_bound(all.blocks_.begin(), all.blocks_.end(), low);
    for (; found != all.blocks_.end() && *found <= high; ++found) {
      if (*found == own) continue;
      copy_from(all.contents_[static_cast<std::size_t>(found - all.blocks_.begin())],
                beyond(*found, own));
    }
  }
}

/// A face of a block beyond which another block lies.
std::size_t BlockDarts::beyond(const BlockIndex& block, const BlockIndex& other) {
  if (other.x != block.x) return other.x < block.x ? 0 : 3;
  if (other.y != block.y) return other.y < block.y ? 1 : 4;
  return other.z < block.z ? 2 : 5;
}

/// Copies the darts of a block at one of its faces whose radius reaches into this block.
void BlockDarts::copy_from(const DartBlocks::Block& other, std::size_t face) {
  for (const std::uint16_t i : other.at_face[face]) {
    const float radius = other.radii.empty() ? all_.rounded_distance_ : std::abs(other.radii[i]);
    const double reach = radius + rounding_mm_;
    if (square_to_box(other.points[i], box_) < reach * reach) enter(other.points[i], radius);
  }
}

void BlockDarts::enter(const geometry::Point& place, float radius_mm) {
  const Cells at = cells_at(place);
  std::int32_t& head = heads_[cell_index(at[0], at[1], at[2])];
  const auto i = static_cast<std::int32_t>(darts_.size());
  darts_.push_back({place, radius_mm, head});
  const std::size_t needed = darts_.size() + read_ahead;
  if (x_.size() < needed) {
    for (std::vector<float>* axis : {&x_, &y_, &z_}) axis->resize(2 * needed);
  }
  const PlaceInBlock in_block = units_.place_of(place);
  x_[darts_.size() - 1] = in_block.x;
  y_[darts_.size() - 1] = in_block.y;
  z_[darts_.size() - 1] = in_block.z;
  head = i;
}

/// Counted from the cells before the block, which take all places before it, as those after the
/// block take all after it.
BlockDarts::Cells BlockDarts::cells_at(const geometry::Point& place) const {
  const auto cell = [&](double coordinate, double from) {
    const double rank = (coordinate - from) * cells_per_mm_ + 1;
    return static_cast<int>(std::min(std::max(rank, 0.0), cells - 1.0));
  };
  return {cell(place.x, box_.low.x), cell(place.y, box_.low.y), cell(place.z, box_.low.z)};
}

/// True if `found(i)` is true for any dart from number `since` in the cells near a place.
template <class Found>
bool BlockDarts::any_in_cells(Index since, const geometry::Point& place, double distance_mm,
                              const Found& found) const {
  const Cells from = cells_at(moved(place, -distance_mm)), to = cells_at(moved(place, distance_mm));
  const auto first = static_cast<std::int32_t>(since);
  for (int z = from[2]; z <= to[2]; ++z) {
    for (int y = from[1]; y <= to[1]; ++y) {
      const std::int32_t* row = &heads_[cell_index(0, y, z)];
      for (int x = from[0]; x <= to[0]; ++x) {
        for (std::int32_t i = row[x]; i >= first; i = darts_[static_cast<std::size_t>(i)].next) {
          if (found(static_cast<Index>(i))) return true;
        }
      }
    }
  }
  return false;
}

bool BlockDarts::is_free(const geometry::Point& at, double radius_mm) const {
  return !any_in_cells(0, at, radius_mm + rounding_mm_, [&](Index i) {
    const double apart = std::min<double>(radius_mm, darts_[i].radius_mm) * (1 + block_rounding);
    return square_of_distance(at, darts_[i].place) < apart * apart;
  });
}

void BlockDarts::find_near(Index since, const geometry::Point& at, double distance_mm,
                           List& list) const {
  const double reach = distance_mm + rounding_mm_, square = reach * reach;
  // Comparing so few darts takes less time than the search in cells.
  constexpr Index few = 1024;
  if (size() - since > few) {
    any_in_cells(since, at, reach, [&](Index i) {
      if (square_of_distance(at, darts_[i].place) < square) list.push_back(i);
      return false;
    });
    return;
  }
  const PlaceInBlock in_block = units_.place_of(at);
  for (Index i = since; i < size(); i += max_set_size) {
    const std::size_t count = std::min<std::size_t>(size() - i, max_set_size);
    const DartSet near = darts_within(&x_[i], &y_[i], &z_[i], nullptr, count, in_block,
                                      units_.square_of(reach), Doubt::is_within);
    for_each_of(near, [&](std::size_t k) { list.push_back(i + static_cast<Index>(k)); });
  }
}

void BlockDarts::add(const Dart& dart) {
  const geometry::Point& p = dart.place;
  const bool plain = dart.visible && dart.radius_mm == all_.distance_;
  const float radius = plain ? all_.rounded_distance_ : rounded_up(dart.radius_mm);
  if (!plain && block_.radii.empty()) {
    block_.radii.assign(block_.points.size(), all_.rounded_distance_);
  }
  if (!plain || !block_.radii.empty()) block_.radii.push_back(dart.visible ? radius : -radius);
  const std::array<double, 6> to_face{p.x - box_.low.x,  p.y - box_.low.y,  p.z - box_.low.z,
                                      box_.high.x - p.x, box_.high.y - p.y, box_.high.z - p.z};
  for (std::size_t face = 0; face < to_face.size(); ++face) {
    if (to_face[face] < radius + rounding_mm_)
      block_.at_face[face].push_back(static_cast<std::uint16_t>(block_.points.size()));
  }
  block_.points.push_back(p);
  enter(p, radius);
}

}  // namespace lamplock::points
