// Darts in blocks of space: searches near darts, and processes blocks in parallel. In: the blocks
// that can have points. Out: the points, block by block. Called by blue_noise() and fill_solid().
//
// A block is 16 distances wide and has 8 x 8 x 8 cells of two distances for the search of points. A
// radius is at most 6 distances, so a dart depends on its own block and the 26 blocks round it.
// Blocks with the same three parities of index do not touch: they are processed in parallel, one
// group of blocks after the other.
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
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {

inline constexpr double block_distances = 16;  // side of a block
inline constexpr double max_radius_distances = 6;

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
  double distance_mm() const { return distance_; }

 private:
  friend class BlockDarts;
  static constexpr std::uint16_t none = 0xFFFF;
  static constexpr unsigned cells = 8;  // in a row of a block

  /// Points by cell as linked lists. 16 bits suffice: a block has at most 6000 points (the densest
  /// arrangement, 2^0.5 points per cubic distance).
  struct Block {
    Block() { heads.fill(none); }
    std::array<std::uint16_t, cells * cells * cells> heads{};
    std::vector<std::uint16_t> next;
    std::vector<geometry::Point> points;
    std::vector<float> radii;  // negative: not visible; empty while all equal the distance
  };

  BlockGrid grid_;
  std::vector<BlockIndex> blocks_;
  double distance_;
  std::vector<Block> contents_;
  std::array<std::vector<std::uint32_t>, 8> groups_;  // of blocks by parity
};

/// Copies of the darts near a piece. The questions are those of BlockDarts, for its parts.
class NearDarts {
 public:
  bool is_covered(const Corners& triangle, double radius) const;
  bool is_covered(const geometry::Point& low, double side_mm, double radius) const;

  void clear() { darts_.clear(); }
  void add(const geometry::Point& place, double radius) { darts_.push_back({place, radius}); }

 private:
  struct NearDart {
    geometry::Point place;
    double radius = 0;
  };
  std::vector<NearDart> darts_;
};

/// One block during its processing, with those round it.
class BlockDarts {
 public:
  BlockDarts(DartBlocks& all, std::size_t block);

  /// No dart is too near to one with `radius` at `place`, which lies in this block.
  bool is_free(const geometry::Point& place, double radius) const;
  /// A single dart excludes others of `radius` from all of a triangle.
  bool is_covered(const Corners& triangle, double radius) const;
  /// The same for a cube with this lowest corner.
  bool is_covered(const geometry::Point& low, double side_mm, double radius) const;
  /// Replaces `near` by the darts nearer than `radius` to a box, and maybe a few more.
  void find_near(const geometry::Bounds& box, double radius, NearDarts& near) const;
  /// Adds a dart that is free.
  void add(const Dart& dart);

 private:
  using Cells = std::array<unsigned, 3>;
  Cells cells_at(const geometry::Point& place) const;
  template <class Found>
  bool any_within(const geometry::Point& low, const geometry::Point& high,
                  const Found& found) const;
  double radius_of(const DartBlocks::Block& block, std::size_t point) const;

  DartBlocks& all_;
  geometry::Point low_;
  double cells_per_mm_;
  std::array<DartBlocks::Block*, 27> around_{};  // null where there is no block; [13] is this one
};

}  // namespace lamplock::points
