// Geometry of cutter compensation: the path of a cutter's centre beside programmed lines and arcs.
//
// In:  blocks in a plane, 10^-7 mm; the radius of the cutter and the side on which it is.
// Out: where the centre begins and ends each block, and how it turns each corner; or that the
//      cutter does not fit.
// Who: compensation.hpp, main loop; a corner costs some 30 000 cycles, mostly for roots.
//
// The centre of the cutter is beside a line on a parallel, beside an arc on an arc with the same
// centre. At an outer corner it turns round the corner on an arc, at an inner corner it changes
// from one path to the other where they intersect ("The NIST RS274/NGC Interpreter - Version 3",
// appendix B; LinuxCNC, "Cutter Compensation"). Intersections are computed relative to the corner
// with ten more bits, so that a place is off by some 10^-7 mm.
//
// Where two blocks meet nearly tangentially, their paths are joined without an arc or an
// intersection if that moves the centre by at most 0.0005 mm: programs round tangent points, and
// intersections of such paths would be far from the corner.
#pragma once

#include <cstdint>

#include "firmware/program/curves/shape.hpp"

namespace lamplock::program {

/// A programmed line or arc in the plane of compensation; not of no length.
struct PlaneBlock {
  PlanePoint from, to, centre;  ///< the centre only of an arc
  bool arc, clockwise;
};

/// How the centre of the cutter changes from one block to the next.
struct CutterCorner {
  PlanePoint end;    ///< of the first block
  PlanePoint begin;  ///< of the second block
  bool arc;          ///< from end to begin round the corner
};

/// What is left of the way beside a block: nothing of an arc, a part, all of a circle, or the
/// cutter would have to go back.
enum class BlockPart : std::uint8_t { none, some, circle, backward };

/// The cutter: where its centre is beside a block.
class CutterOffset {
 public:
  void begin(std::int64_t radius_e7, bool left) {
    radius_e7_ = radius_e7;
    left_ = left;
  }
  std::int64_t radius_e7() const { return radius_e7_; }
  /// On an arc round a corner the centre turns clockwise.
  bool turns_clockwise() const { return left_; }

  /// The arc is not tighter than the cutter; of a line always true.
  bool fits_into(const PlaneBlock& block) const;
  /// Place of the centre at the end of a block without regard to the next one.
  PlanePoint beside_end(const PlaneBlock& block) const;
  /// False if the cutter does not fit between the blocks.
  bool turn_corner(const PlaneBlock& first, const PlaneBlock& second, CutterCorner& corner) const;
  /// Compares the way of the centre from `begin` to `end` with the block.
  BlockPart part_of(const PlaneBlock& block, const PlanePoint& begin, const PlanePoint& end) const;

 private:
  std::int64_t radius_e7_;
  bool left_;
};

/// Distance of two places.
std::int64_t distance_e7(const PlanePoint& a, const PlanePoint& b);

}  // namespace lamplock::program
