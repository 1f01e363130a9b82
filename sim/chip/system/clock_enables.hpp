// WAKE_EN0 and WAKE_EN1 of CLOCKS: the clock and the block of each bit (RP2040 datasheet, 2.15.7).
//
// Out: a table. Who: Clocks, to report which clock is not stopped although it should be; the blocks
//      that do stop, by their bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/chip/system/resets.hpp"

namespace lamplock::sim::chip {

/// One bit. Blocks that RESETS does not hold are always in use.
struct ClockEnable {
  std::string_view clock;
  bool has_reset = false;
  ResetBit reset = ResetBit::adc;

  constexpr ClockEnable(std::string_view name) : clock(name) {}
  constexpr ClockEnable(std::string_view name, ResetBit bit)
      : clock(name), has_reset(true), reset(bit) {}
};

/// Bit n of WAKE_EN0, then of WAKE_EN1.
inline constexpr std::array<ClockEnable, 47> clock_enables{{
    {"clk_sys_clocks"},
    {"clk_adc_adc", ResetBit::adc},
    {"clk_sys_adc", ResetBit::adc},
    {"clk_sys_busctrl", ResetBit::busctrl},
    {"clk_sys_busfabric"},
    {"clk_sys_dma", ResetBit::dma},
    {"clk_sys_i2c0", ResetBit::i2c0},
    {"clk_sys_i2c1", ResetBit::i2c1},
    {"clk_sys_io", ResetBit::io_bank0},
    {"clk_sys_jtag", ResetBit::jtag},
    {"clk_sys_vreg_and_chip_reset"},
    {"clk_sys_pads", ResetBit::pads_bank0},
    {"clk_sys_pio0", ResetBit::pio0},
    {"clk_sys_pio1", ResetBit::pio1},
    {"clk_sys_pll_sys", ResetBit::pll_sys},
    {"clk_sys_pll_usb", ResetBit::pll_usb},
    {"clk_sys_psm"},
    {"clk_sys_pwm", ResetBit::pwm},
    {"clk_sys_resets"},
    {"clk_sys_rom"},
    {"clk_sys_rosc"},
    {"clk_rtc_rtc", ResetBit::rtc},
    {"clk_sys_rtc", ResetBit::rtc},
    {"clk_sys_sio"},
    {"clk_peri_spi0", ResetBit::spi0},
    {"clk_sys_spi0", ResetBit::spi0},
    {"clk_peri_spi1", ResetBit::spi1},
    {"clk_sys_spi1", ResetBit::spi1},
    {"clk_sys_sram0"},
    {"clk_sys_sram1"},
    {"clk_sys_sram2"},
    {"clk_sys_sram3"},
    {"clk_sys_sram4"},
    {"clk_sys_sram5"},
    {"clk_sys_syscfg", ResetBit::syscfg},
    {"clk_sys_sysinfo", ResetBit::sysinfo},
    {"clk_sys_tbman", ResetBit::tbman},
    {"clk_sys_timer", ResetBit::timer},
    {"clk_peri_uart0", ResetBit::uart0},
    {"clk_sys_uart0", ResetBit::uart0},
    {"clk_peri_uart1", ResetBit::uart1},
    {"clk_sys_uart1", ResetBit::uart1},
    {"clk_sys_usbctrl", ResetBit::usbctrl},
    {"clk_usb_usbctrl", ResetBit::usbctrl},
    {"clk_sys_watchdog"},
    {"clk_sys_xip"},
    {"clk_sys_xosc"},
}};

/// The bits that stop a modelled clock: numbered as in the table.
enum class ClockGate : std::uint8_t {
  adc_adc = 1,
  sys_adc = 2,
  sys_dma = 5,
  sys_pio0 = 12,
  sys_pio1 = 13,
  sys_pwm = 17,
  rtc_rtc = 21,
  sys_rtc = 22,
  peri_spi0 = 24,
  sys_spi0 = 25,
  peri_spi1 = 26,
  sys_spi1 = 27,
  sys_timer = 37,
  peri_uart0 = 38,
  sys_uart0 = 39,
  peri_uart1 = 40,
  sys_uart1 = 41,
  sys_watchdog = 44
};

/// Of the others, those that matter while both cores sleep and the DMA is idle: I2C0, I2C1, IO
/// (edges of pins that wake), the two of USB. Memories and the bus do not matter.
inline constexpr std::array<std::size_t, 5> clocks_missed_asleep{6, 7, 8, 42, 43};

}  // namespace lamplock::sim::chip
