// Where points may be: inside the block less its margin, and where the machine's focus can go.
//
// In:  what is said about the glass, the work space of the machine. Out: the refraction, and boxes
//      in glass coordinates. Who: the placement of objects, the check of their points, making jobs.
//
// The block lies in the middle of the work space unless it is told where. Its top is the entry
// face; without a block that is the top of the work space.
#pragma once

#include <optional>

#include "host/glass/block.hpp"
#include "host/glass/description.hpp"
#include "host/glass/refraction.hpp"
#include "host/points/bounds.hpp"

namespace lamplock::glass {

/// The place for a job. Coordinates of the glass, mm.
struct Volume {
  std::optional<Block> block{};
  Refraction refraction{};
  points::Bounds reach{};  ///< of the focus: the work space, seen through the glass
  points::Point centre{};  ///< of what has no other place

  /// Where points may be.
  points::Bounds room() const;
  /// Of the block, or of the work space: what objects are turned and mirrored about.
  points::Point middle() const;
};

/// `centre`: where the block lies that is not told where, and objects without a block; by default
/// the middle of the work space. Throws Error(bad_input): a material and an index, an index below
/// 1, a block that is none, a block of which the machine reaches nothing, a place of a block that
/// is not there.
Volume volume_of(const GlassChoice& glass, const points::Bounds& work_space,
                 const std::optional<points::Point>& centre = std::nullopt);

}  // namespace lamplock::glass
