// Voltage regulator and chip-level reset (RP2040 datasheet, 2.10.6 and 2.12.8).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct VregRegisters {
  Register vreg;
  Register bod;
  Register chip_reset;
};
static_assert(offsetof(VregRegisters, chip_reset) == 0x8);

inline VregRegisters& vreg_and_chip_reset() {
  return *reinterpret_cast<VregRegisters*>(0x40064000);
}

namespace vreg_field {
inline constexpr std::uint32_t voltage_mask = 0xf << 4;
inline constexpr std::uint32_t voltage_1_15 = 0xc << 4;
inline constexpr std::uint32_t in_regulation = 1u << 12;
}  // namespace vreg_field

namespace chip_reset_bit {
inline constexpr std::uint32_t had_run_pin = 1u << 16;
inline constexpr std::uint32_t had_debugger = 1u << 20;
}  // namespace chip_reset_bit

}  // namespace lamplock::rp2040
