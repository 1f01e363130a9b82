#include "sim/trace/vcd.hpp"

#include <array>

#include "sim/world/pin_names.hpp"

namespace lamplock::sim {
namespace {

std::array<VcdFile::Signal, pin_count> signals(const PinBus& bus) {
  std::array<VcdFile::Signal, pin_count> result{};
  for (std::size_t pin = 0; pin < pin_count; ++pin)
    result[pin] = {pin_names[pin], bus.level(static_cast<Pin>(pin))};
  return result;
}

}  // namespace

VcdWriter::VcdWriter(std::ostream& out, PinBus& bus) : file_(out, "machine", signals(bus)) {
  for (std::size_t pin = 0; pin < pin_count; ++pin) bus.listen(static_cast<Pin>(pin), *this);
}

VcdWriter::~VcdWriter() { finish(); }

void VcdWriter::pin_changed(Pin pin, bool level, Picoseconds at) {
  file_.change(static_cast<std::size_t>(pin), level, at);
}

}  // namespace lamplock::sim
