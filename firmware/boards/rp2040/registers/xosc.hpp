// Crystal oscillator (RP2040 datasheet, 2.16.7).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct XoscRegisters {
  Register ctrl;
  Register status;
  Register dormant;
  Register startup;
  Register reserved[3];
  Register count;
};
static_assert(offsetof(XoscRegisters, startup) == 0xc);
static_assert(offsetof(XoscRegisters, count) == 0x1c);

inline XoscRegisters& xosc() { return *reinterpret_cast<XoscRegisters*>(0x40024000); }

namespace xosc_field {
inline constexpr std::uint32_t freq_range_1_15_mhz = 0xaa0;
inline constexpr std::uint32_t enable = 0xfabu << 12;
inline constexpr std::uint32_t stable = 1u << 31;
}  // namespace xosc_field

}  // namespace lamplock::rp2040
