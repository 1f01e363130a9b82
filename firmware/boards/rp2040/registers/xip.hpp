// Flash as memory (RP2040 datasheet, 2.6.3.2).
#pragma once

#include <cstdint>

namespace lamplock::rp2040 {

/// Uncached.
inline const volatile std::uint8_t* xip_nocache() {
  return reinterpret_cast<const volatile std::uint8_t*>(0x13000000);
}

}  // namespace lamplock::rp2040
