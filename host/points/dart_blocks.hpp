// Darts in blocks of space: who is near, and which blocks may be worked on at once. Comes in: the
// blocks that can take points. Goes out: the points, block by block. Called by blue_noise() and
// fill_solid().
//
// A block is 16 distances wide and has 8 x 8 x 8 cells of two distances, in which a search looks up
// points. A radius is at most 6 distances, so a dart depends on its own block and the 26 round it.
// Blocks with the same three parities of index do not touch: they are worked on in parallel, one
// group of blocks after the other.
//
// Two darts may be as near as the smaller of their radii: places of low density beside places of
// high density do not push the points of those away.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/points/point.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {

inline constexpr double block_distances = 16;  // side of a block
inline constexpr double most_radius_distances = 6;

struct Dart {
  Point place;
  double radius_mm = 0;
  bool visible = true;  // others only keep their radius free, for densities below 1 / 36
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

  /// The visible points, block by block. Leaves nothing behind.
  PointCloud take();

  const BlockIndex& index(std::size_t block) const { return blocks_[block]; }
  Bounds box(std::size_t block) const { return grid_.box(blocks_[block]); }
  double distance_mm() const { return distance_; }

 private:
  friend class BlockDarts;
  static constexpr std::uint16_t none = 0xFFFF;
  static constexpr unsigned cells = 8;  // in a row of a block

  /// Points by cell as linked lists. 16 bits suffice: a block has room for 6000 points (the densest
  /// arrangement, 2^0.5 points a cubic distance).
  struct Block {
    Block() { heads.fill(none); }
    std::array<std::uint16_t, cells * cells * cells> heads{};
    std::vector<std::uint16_t> next;
    std::vector<Point> points;
    std::vector<float> radii;  // negative: not visible; empty as long as all have the distance
  };

  BlockGrid grid_;
  std::vector<BlockIndex> blocks_;
  double distance_;
  std::vector<Block> contents_;
  std::array<std::vector<std::uint32_t>, 8> groups_;  // of blocks by parity
};

/// One block that is worked on, with those round it.
class BlockDarts {
 public:
  BlockDarts(DartBlocks& all, std::size_t block);

  /// No dart is too near to one with `radius` at `place`, which lies in this block.
  bool is_free(const Point& place, double radius) const;
  /// One dart alone keeps all of a triangle from others of `radius`.
  bool is_covered(const Corners& triangle, double radius) const;
  /// The same for a cube with this lowest corner.
  bool is_covered(const Point& low, double side_mm, double radius) const;
  /// Adds a dart that is free.
  void add(const Dart& dart);

 private:
  using Cells = std::array<unsigned, 3>;
  Cells cells_at(const Point& place) const;
  template <class Found>
  bool any_within(const Point& low, const Point& high, const Found& found) const;
  double radius_of(const DartBlocks::Block& block, std::size_t point) const;

  DartBlocks& all_;
  Point low_;
  double cells_per_mm_;
  std::array<DartBlocks::Block*, 27> around_{};  // null where there is no block; [13] is this one
};

}  // namespace lamplock::points
