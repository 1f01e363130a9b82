#include "host/run/bounds_text.hpp"

#include <fmt/format.h>

#include "host/number_text.hpp"

namespace lamplock::run {

std::string bounds_text(const geometry::Bounds& b) {
  const auto side = [](double low, double high) {
    return number_text(low) + ".." + number_text(high);
  };
  return fmt::format("x {}, y {}, z {} mm", side(b.low.x, b.high.x), side(b.low.y, b.high.y),
                     side(b.low.z, b.high.z));
}

}  // namespace lamplock::run
