// Changes that the DMA makes to the data of a transfer of 8, 16 or 32 bits.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip {

/// The order of the bytes reversed (CTRL BSWAP, SNIFF_CTRL BSWAP).
constexpr std::uint32_t swap_bytes(std::uint32_t value, unsigned bits) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < bits; i += 8) result |= (value >> i & 0xffu) << (bits - 8 - i);
  return result;
}

constexpr std::uint32_t reverse_bits(std::uint32_t value, unsigned bits) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < bits; ++i) result |= (value >> i & 1u) << (bits - 1 - i);
  return result;
}

}  // namespace lamplock::sim::chip
