// User pads (RP2040 datasheet, 2.19.6.3).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct PadsBank0Registers {
  Register voltage_select;
  Register gpio[30];
  Register swclk;
  Register swd;
};
static_assert(offsetof(PadsBank0Registers, gpio) == 0x4);
static_assert(offsetof(PadsBank0Registers, swd) == 0x80);

inline PadsBank0Registers& pads_bank0() {
  return *reinterpret_cast<PadsBank0Registers*>(0x4001c000);
}

namespace pad {
inline constexpr std::uint32_t schmitt = 1u << 1;
inline constexpr std::uint32_t pull_down = 1u << 2;
inline constexpr std::uint32_t pull_up = 1u << 3;
inline constexpr std::uint32_t drive_4ma = 1u << 4;
inline constexpr std::uint32_t input_enable = 1u << 6;
/// Has priority over the output enable of peripherals.
inline constexpr std::uint32_t output_disable = 1u << 7;
}  // namespace pad

}  // namespace lamplock::rp2040
