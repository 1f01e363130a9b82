// Atomic register aliases of the RP2040 (datasheet, 2.1.2): a write to register + 0x2000 sets,
// + 0x3000 clears the bits written. Not for SIO and not for memory.
#pragma once

#include <cstdint>

namespace lamplock::rp2040 {

/// A hardware register.
using Register = volatile std::uint32_t;

inline Register& alias(Register& reg, std::uintptr_t offset) {
  return *(&reg + offset / sizeof(Register));
}
inline void set_bits(Register& reg, std::uint32_t bits) { alias(reg, 0x2000) = bits; }
inline void clear_bits(Register& reg, std::uint32_t bits) { alias(reg, 0x3000) = bits; }

}  // namespace lamplock::rp2040
