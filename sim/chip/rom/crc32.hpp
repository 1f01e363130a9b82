// The checksum of the second-stage boot code (RP2040 datasheet, 2.8.1.3.1): CRC-32 with polynomial
// 0x04c11db7, most significant bit first, start value all ones, nothing inverted at the end.
#pragma once

#include <cstdint>
#include <span>

namespace lamplock::sim::chip {

constexpr std::uint32_t boot2_crc32(std::span<const std::uint8_t> data) {
  std::uint32_t crc = 0xffff'ffff;
  for (const std::uint8_t byte : data) {
    crc ^= static_cast<std::uint32_t>(byte) << 24;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x8000'0000u) != 0 ? crc << 1 ^ 0x04c1'1db7u : crc << 1;
  }
  return crc;
}

}  // namespace lamplock::sim::chip
