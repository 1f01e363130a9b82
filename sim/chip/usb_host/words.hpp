// Words in the bytes of descriptors, little endian (USB 2.0, 8.1). Called by their readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lamplock::sim::chip::usb {

inline std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

}  // namespace lamplock::sim::chip::usb
