#include "host/glass/volume.hpp"

#include <algorithm>

#include "host/error.hpp"
#include "host/glass/material.hpp"

namespace lamplock::glass {
namespace {

using geometry::Bounds;
using geometry::Point;

Point point_of(const Triple& three) { return {three[0], three[1], three[2]}; }

Bounds common(const Bounds& a, const Bounds& b) {
  return {
      {std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)},
      {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)}};
}

double chosen_index(const GlassChoice& glass) {
  if (glass.material && glass.index)
    throw Error(Exit::bad_input, "glass", "material and index are both given", "give one of them");
  const double index = glass.material ? index_of(*glass.material) : glass.index.value_or(1);
  require_index(index, "glass");
  return index;
}

}  // namespace

Bounds Volume::room() const { return block ? common(reach, block->inside()) : reach; }

Point Volume::middle() const { return block ? block->middle_mm : centre; }

Volume volume_of(const GlassChoice& glass, const Bounds& work_space,
                 const std::optional<Point>& centre) {
  if (glass.block_at_mm && !glass.block_mm)
    throw Error(Exit::bad_input, "block", "has a position but no size",
                "give its size too, or neither");
  Volume volume;
  volume.refraction = {chosen_index(glass), work_space.high.z};
  if (glass.block_mm) {
    volume.block =
        Block{point_of(*glass.block_mm), centre.value_or(work_space.centre()), glass.margin_mm};
    if (glass.block_at_mm) volume.block->middle_mm = point_of(*glass.block_at_mm);
    require_block(*volume.block);
    volume.refraction.entry_mm = volume.block->entry_mm();
  }
  volume.reach = volume.refraction.reach(work_space);
  volume.centre = centre.value_or(volume.reach.centre());
  const Bounds room = volume.room();
  if (room.low.x > room.high.x || room.low.y > room.high.y || room.low.z > room.high.z)
    throw Error(Exit::bad_input, "block", "lies outside the machine's travel",
                "check its size and middle, and travel and min_corner of the machine");
  return volume;
}

}  // namespace lamplock::glass
