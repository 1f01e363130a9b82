#include "host/cli/bounds_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace lamplock::cli {

using points::Bounds;

std::string bounds_text(const Bounds& b) {
  return fmt::format("x {:.4g}..{:.4g}, y {:.4g}..{:.4g}, z {:.4g}..{:.4g} mm", b.low.x, b.high.x,
                     b.low.y, b.high.y, b.low.z, b.high.z);
}

Json bounds_json(const Bounds& b) {
  return {{"low_mm", {b.low.x, b.low.y, b.low.z}}, {"high_mm", {b.high.x, b.high.y, b.high.z}}};
}

}  // namespace lamplock::cli
