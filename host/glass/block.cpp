#include "host/glass/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"

namespace lamplock::glass {
namespace {

geometry::Bounds box_of(const Block& block, double margin_mm) {
  const geometry::Point& m = block.middle_mm;
  const geometry::Point half{block.size_mm.x / 2 - margin_mm, block.size_mm.y / 2 - margin_mm,
                             block.size_mm.z / 2 - margin_mm};
  return {{m.x - half.x, m.y - half.y, m.z - half.z}, {m.x + half.x, m.y + half.y, m.z + half.z}};
}

}  // namespace

geometry::Bounds Block::outside() const { return box_of(*this, 0); }
geometry::Bounds Block::inside() const { return box_of(*this, margin_mm); }

void require_block(const Block& block) {
  const geometry::Point& size = block.size_mm;
  const auto refuse = [&](const std::string& what, const char* remedy) {
    throw Error(Exit::bad_input, fmt::format("block {:g} x {:g} x {:g} mm", size.x, size.y, size.z),
                what, remedy);
  };
  const double shortest = std::min({size.x, size.y, size.z});
  if (!geometry::is_finite(size) || !(shortest > 0))
    refuse("has no volume", "give three sides in mm, all greater than 0");
  if (!geometry::is_finite(block.middle_mm))
    refuse("its middle is not finite", "give its middle in mm");
  if (!(block.margin_mm >= 0) || !std::isfinite(block.margin_mm))
    refuse(fmt::format("a margin of {:g} mm is not allowed", block.margin_mm),
           "give 0 mm or more, usually 3 to 5");
  if (!(2 * block.margin_mm < shortest))
    refuse(fmt::format("a margin of {:g} mm leaves no room for points", block.margin_mm),
           "use a larger block or a smaller margin");
}

}  // namespace lamplock::glass
