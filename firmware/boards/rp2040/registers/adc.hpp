// Analogue to digital converter (RP2040 datasheet, 4.9.6).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct AdcRegisters {
  Register cs;
  Register result;  ///< of the last conversion, 12 bits
  Register fcs;
  Register fifo;
  Register div;  ///< 16.8 fixed point; 0: conversions one after the other
};
static_assert(offsetof(AdcRegisters, div) == 0x10);

inline AdcRegisters& adc() { return *reinterpret_cast<AdcRegisters*>(0x4004c000); }

namespace adc_cs {
inline constexpr std::uint32_t enable = 1u << 0;
inline constexpr std::uint32_t start_once = 1u << 2;
inline constexpr std::uint32_t start_many = 1u << 3;
inline constexpr std::uint32_t ready = 1u << 8;
constexpr std::uint32_t input(std::uint32_t number) { return number << 12; }
}  // namespace adc_cs

}  // namespace lamplock::rp2040
