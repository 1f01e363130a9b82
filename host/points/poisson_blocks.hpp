// Darts in blocks of space: searches near darts, and processes blocks in parallel. In: the blocks
// that can have points. Out: the points, block by block. Called by blue_noise() and fill_solid().
//
// A block is 16 distances wide. A radius is at most 6 distances, so a dart depends on its own block
// and the 26 blocks round it. Blocks with the same three parities of index do not touch: they are
// processed in parallel, one group of blocks after the other.
//
// Two darts may be as near as the smaller of their radii: so regions of low density do not displace
// points of neighbouring regions with high density.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/near_darts.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {

/// Side of a block: above max_radius_distances, so that a search needs no block but the neighbours.
inline constexpr double block_distances = 16;
/// A lower density is a share of the darts of this radius that is visible (Dart::visible).
inline constexpr double max_radius_distances = 6;
/// Relative addition to the distance between darts, so that rounding never makes it less.
inline constexpr double block_rounding = 1e-12;

struct Dart {
  geometry::Point place;
  double radius_mm = 0;
  bool visible = true;  // invisible ones only keep their radius free, for densities below 1 / 36
};

class BlockDarts;

class DartBlocks {
 public:
  /// The side of the grid's blocks is block_distances * distance_mm; `blocks` in ascending order.
  DartBlocks(const BlockGrid& grid, std::vector<BlockIndex> blocks, double distance_mm);

  /// Calls `work(i, darts)` once for every block i; the same result for any number of threads.
  void for_each(unsigned threads, const std::function<void(std::size_t, BlockDarts&)>& work);

  /// Points so far, the invisible ones too.
  std::size_t count() const;

  /// Returns the visible points, block by block, and clears all blocks.
  geometry::PointCloud take();

  const BlockIndex& index(std::size_t block) const { return blocks_[block]; }
  geometry::Bounds box(std::size_t block) const { return grid_.box(blocks_[block]); }

 private:
  friend class BlockDarts;

  /// 16 bits suffice for the number of a point: a block has at most 7000 (the densest arrangement
  /// has 2^0.5 points per cubic distance; half a distance at each side is part of it).
  struct Block {
    std::vector<geometry::Point> points;
    std::vector<float> radii;  // negative: not visible; empty while all equal the distance
    /// Points whose radius reaches beyond a face of the block: low x, y, z, high x, y, z.
    std::array<std::vector<std::uint16_t>, 6> at_face;
  };

  BlockGrid grid_;
  std::vector<BlockIndex> blocks_;
  double distance_;
  float rounded_distance_;
  std::vector<Block> contents_;
  std::array<std::vector<std::uint32_t>, 8> groups_;  // of blocks by parity
};

/// One block during its processing, with copies of the darts of other blocks whose radius reaches
/// into it.
class BlockDarts {
 public:
  BlockDarts(DartBlocks& all, std::size_t block);

  /// Number of a dart. Those of add() follow the earlier ones.
  using Index = std::uint32_t;
  using List = std::vector<Index>;

  Index size() const { return static_cast<Index>(darts_.size()); }
  const BlockUnits& units() const { return units_; }
  PlaceInBlock place(Index i) const { return {x_[i], y_[i], z_[i]}; }
  double radius_mm(Index i) const { return darts_[i].radius_mm; }

  /// No dart is too near to one with `radius_mm` at `place`, which lies in this block.
  bool is_free(const geometry::Point& place, double radius_mm) const;
  /// Adds to `list` the darts from number `since` nearer to a place than `distance_mm`, and maybe a
  /// few more.
  void find_near(Index since, const geometry::Point& place, double distance_mm, List& list) const;
  /// A dart excludes others from a place nearer to `place` than `distance_mm`, or almost.
  bool reaches(Index i, const geometry::Point& place, double distance_mm) const {
    const double reach = darts_[i].radius_mm + distance_mm + rounding_mm_;
    return square_of_distance(place, darts_[i].place) < reach * reach;
  }
  /// Adds a dart that is free.
  void add(const Dart& dart);

 private:
  static constexpr double cell_distances = 2;
  /// In a row; the first and the last one are outside the block.
  static constexpr int cells = static_cast<int>(block_distances / cell_distances) + 2;
  using Cells = std::array<int, 3>;

  /// Darts by cell as linked lists, the latest first.
  struct Listed {
    geometry::Point place;
    float radius_mm;
    std::int32_t next;  // -1 at the end
  };

  static std::size_t beyond(const BlockIndex& block, const BlockIndex& other);
  void copy_from(const DartBlocks::Block& other, std::size_t face);
  void enter(const geometry::Point& place, float radius_mm);
  static std::size_t cell_index(int x, int y, int z) {
    constexpr auto n = static_cast<std::size_t>(cells);
    return (static_cast<std::size_t>(z) * n + static_cast<std::size_t>(y)) * n +
           static_cast<std::size_t>(x);
  }
  Cells cells_at(const geometry::Point& place) const;
  template <class Found>
  bool any_in_cells(Index since, const geometry::Point& place, double distance_mm,
                    const Found& found) const;

  DartBlocks& all_;
  DartBlocks::Block& block_;
  geometry::Bounds box_;
  BlockUnits units_;
  double cells_per_mm_;
  double rounding_mm_;
  std::vector<Listed> darts_;
  std::vector<float> x_, y_, z_;  // of all darts, and read_ahead more
  std::array<std::int32_t, static_cast<std::size_t>(cells* cells* cells)> heads_;
};

}  // namespace lamplock::points
