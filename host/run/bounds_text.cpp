#include "host/run/bounds_text.hpp"

#include <fmt/format.h>

namespace lamplock::run {

std::string bounds_text(const geometry::Bounds& b) {
  return fmt::format("x {:.4g}..{:.4g}, y {:.4g}..{:.4g}, z {:.4g}..{:.4g} mm", b.low.x, b.high.x,
                     b.low.y, b.high.y, b.low.z, b.high.z);
}

}  // namespace lamplock::run
