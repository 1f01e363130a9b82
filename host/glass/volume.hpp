// The volume for points: inside the margin of the block and the travel of the machine's focus.
//
// In:  the parameters of the glass, the work space of the machine. Out: the refraction, and boxes
//      in glass coordinates. Who: the placement of objects, the check of their points, making jobs.
//
// By default the block lies in the middle of the work space. Its top is the entry face; without a
// block that is the top of the work space.
#pragma once

#include <optional>

#include "host/geometry/bounds.hpp"
#include "host/glass/block.hpp"
#include "host/glass/description.hpp"
#include "host/glass/refraction.hpp"

namespace lamplock::glass {

/// The volume for a job. Coordinates of the glass, mm.
struct Volume {
  std::optional<Block> block{};
  Refraction refraction{};
  geometry::Bounds reach{};  ///< travel of the focus: the work space after refraction
  geometry::Point centre{};  ///< middle of objects without a position, if there is no block

  /// The box for points.
  geometry::Bounds room() const;
  /// Middle of the block, or of the work space: objects are rotated and mirrored about it.
  geometry::Point middle() const;
};

/// `centre`: default middle of the block, and of objects without a block; by default the middle of
/// the work space. Throws Error(bad_input): a material and an index, an index below 1, an invalid
/// block, a block outside the machine's travel, a position without a block.
Volume volume_of(const GlassChoice& glass, const geometry::Bounds& work_space,
                 const std::optional<geometry::Point>& centre = std::nullopt);

}  // namespace lamplock::glass
