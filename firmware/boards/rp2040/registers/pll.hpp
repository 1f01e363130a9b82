// Phase-locked loops (RP2040 datasheet, 2.18.4).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct PllRegisters {
  Register cs;
  Register pwr;
  Register fbdiv_int;
  Register prim;
};
static_assert(offsetof(PllRegisters, prim) == 0xc);

inline PllRegisters& pll_sys() { return *reinterpret_cast<PllRegisters*>(0x40028000); }
inline PllRegisters& pll_usb() { return *reinterpret_cast<PllRegisters*>(0x4002c000); }

namespace pll_field {
inline constexpr std::uint32_t lock = 1u << 31;         // CS
inline constexpr std::uint32_t power_down = 1u << 0;    // PWR
inline constexpr std::uint32_t postdiv_down = 1u << 3;  // PWR
inline constexpr std::uint32_t vco_down = 1u << 5;      // PWR
inline constexpr std::uint32_t postdiv1_shift = 16;     // PRIM
inline constexpr std::uint32_t postdiv2_shift = 12;     // PRIM
}  // namespace pll_field

}  // namespace lamplock::rp2040
