// Subsystem resets (RP2040 datasheet, 2.14.3): a set bit holds a block in reset.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct ResetsRegisters {
  Register reset;
  Register wdsel;  ///< blocks that the watchdog resets by itself
  Register reset_done;
};
static_assert(offsetof(ResetsRegisters, reset_done) == 0x8);

inline ResetsRegisters& resets() { return *reinterpret_cast<ResetsRegisters*>(0x4000c000); }

namespace reset_bit {
inline constexpr std::uint32_t adc = 1u << 0;
inline constexpr std::uint32_t busctrl = 1u << 1;
inline constexpr std::uint32_t dma = 1u << 2;
inline constexpr std::uint32_t i2c0 = 1u << 3;
inline constexpr std::uint32_t i2c1 = 1u << 4;
inline constexpr std::uint32_t io_bank0 = 1u << 5;
inline constexpr std::uint32_t io_qspi = 1u << 6;
inline constexpr std::uint32_t jtag = 1u << 7;
inline constexpr std::uint32_t pads_bank0 = 1u << 8;
inline constexpr std::uint32_t pads_qspi = 1u << 9;
inline constexpr std::uint32_t pio0 = 1u << 10;
inline constexpr std::uint32_t pio1 = 1u << 11;
inline constexpr std::uint32_t pll_sys = 1u << 12;
inline constexpr std::uint32_t pll_usb = 1u << 13;
inline constexpr std::uint32_t pwm = 1u << 14;
inline constexpr std::uint32_t rtc = 1u << 15;
inline constexpr std::uint32_t spi0 = 1u << 16;
inline constexpr std::uint32_t spi1 = 1u << 17;
inline constexpr std::uint32_t syscfg = 1u << 18;
inline constexpr std::uint32_t sysinfo = 1u << 19;
inline constexpr std::uint32_t tbman = 1u << 20;
inline constexpr std::uint32_t timer = 1u << 21;
inline constexpr std::uint32_t uart0 = 1u << 22;
inline constexpr std::uint32_t uart1 = 1u << 23;
inline constexpr std::uint32_t usbctrl = 1u << 24;
inline constexpr std::uint32_t all = (1u << 25) - 1;
}  // namespace reset_bit

/// Takes blocks out of reset and waits until they are ready. Their clocks must run.
[[gnu::always_inline]] inline void release_reset(std::uint32_t blocks) {
  clear_bits(resets().reset, blocks);
  while ((resets().reset_done & blocks) != blocks) {
  }
}

}  // namespace lamplock::rp2040
