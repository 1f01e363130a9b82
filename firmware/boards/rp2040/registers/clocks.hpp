// Clock generators (RP2040 datasheet, 2.15.7).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct ClockGenerator {
  Register ctrl;
  Register div;       ///< 24.8 fixed point
  Register selected;  ///< one-hot; glitchless multiplexers only
};

struct ClocksRegisters {
  ClockGenerator gpout[4];
  ClockGenerator ref;
  ClockGenerator sys;
  ClockGenerator peri;
  ClockGenerator usb;
  ClockGenerator adc;
  ClockGenerator rtc;
  Register sys_resus_ctrl;
  Register sys_resus_status;
};
static_assert(offsetof(ClocksRegisters, ref) == 0x30);
static_assert(offsetof(ClocksRegisters, sys) == 0x3c);
static_assert(offsetof(ClocksRegisters, peri) == 0x48);
static_assert(offsetof(ClocksRegisters, usb) == 0x54);
static_assert(offsetof(ClocksRegisters, sys_resus_ctrl) == 0x78);

inline ClocksRegisters& clocks() { return *reinterpret_cast<ClocksRegisters*>(0x40008000); }

namespace clock_field {
inline constexpr std::uint32_t ref_source_xosc = 2;
inline constexpr std::uint32_t sys_source_ref = 0;
inline constexpr std::uint32_t sys_source_aux = 1;
inline constexpr std::uint32_t sys_aux_pll_sys = 0u << 5;
inline constexpr std::uint32_t peri_aux_sys = 0u << 5;
inline constexpr std::uint32_t usb_aux_pll_usb = 0u << 5;
inline constexpr std::uint32_t adc_aux_pll_usb = 0u << 5;
inline constexpr std::uint32_t enable = 1u << 11;  ///< generators without glitchless multiplexer
inline constexpr std::uint32_t divide_by_1 = 1u << 8;
}  // namespace clock_field

}  // namespace lamplock::rp2040
