// The checksum of an RP2040's second-stage boot code (RP2040 datasheet, 2.8.1.3.1), which its ROM
// expects after the first 252 bytes of the flash: CRC-32 with polynomial 0x04c11db7, most
// significant bit first, start value all ones, not inverted at the end.
//
// In:  those bytes. Out: the checksum. Who: readers of image files, the simulated ROM.
// Frames and files use another CRC, wire/crc32.hpp; toolchain/image has this one in Python too.
#pragma once

#include <cstdint>
#include <span>

namespace lamplock::boards {

constexpr std::uint32_t boot2_crc32(std::span<const std::uint8_t> data) {
  std::uint32_t crc = 0xffff'ffff;
  for (const std::uint8_t byte : data) {
    crc ^= static_cast<std::uint32_t>(byte) << 24;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x8000'0000u) != 0 ? crc << 1 ^ 0x04c1'1db7u : crc << 1;
  }
  return crc;
}

}  // namespace lamplock::boards
