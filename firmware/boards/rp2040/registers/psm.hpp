// Power-on state machine (RP2040 datasheet, 2.13.5).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct PsmRegisters {
  Register frce_on;
  Register frce_off;
  Register wdsel;  ///< parts that a watchdog reset restarts; none after power-on
  Register done;
};
static_assert(offsetof(PsmRegisters, wdsel) == 0x8);

inline PsmRegisters& psm() { return *reinterpret_cast<PsmRegisters*>(0x40010000); }

namespace psm_bit {
inline constexpr std::uint32_t rosc = 1u << 0;
inline constexpr std::uint32_t xosc = 1u << 1;
inline constexpr std::uint32_t proc1 = 1u << 16;
inline constexpr std::uint32_t all = (1u << 17) - 1;
}  // namespace psm_bit

}  // namespace lamplock::rp2040
