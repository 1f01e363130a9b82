#include "sim/chip/trace/pad_trace.hpp"

#include <array>
#include <string>

namespace lamplock::sim::chip {
namespace {

const std::array<std::string, gpio_count>& names() {
  static const std::array<std::string, gpio_count> all = [] {
    std::array<std::string, gpio_count> made;
    for (unsigned gpio = 0; gpio < gpio_count; ++gpio) made[gpio] = "gpio" + std::to_string(gpio);
    return made;
  }();
  return all;
}

std::array<VcdFile::Signal, gpio_count> signals(std::uint32_t levels) {
  std::array<VcdFile::Signal, gpio_count> result{};
  for (unsigned gpio = 0; gpio < gpio_count; ++gpio)
    result[gpio] = {names()[gpio], (levels >> gpio & 1u) != 0};
  return result;
}

}  // namespace

PadTrace::PadTrace(std::ostream& out, Chip& chip)
    : wheel_(chip.wheel()), file_(out, "rp2040", signals(chip.gpio().pad_levels())) {
  chip.gpio().listen(static_cast<PadListener&>(*this));
}

}  // namespace lamplock::sim::chip
