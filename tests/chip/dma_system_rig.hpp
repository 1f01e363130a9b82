// The system blocks with a bus and the DMA, for tests of DREQs; extends SystemRig.
//
// In:  nothing; out: blocks released from reset, accessible through the bus at their addresses.
// Used by the tests of ADC, SPI and I2C.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/pio_dma_clock.hpp"
#include "tests/chip/system_rig.hpp"

namespace lamplock::sim::chip::rigs {

struct DmaSystemRig : SystemRig {
  static constexpr std::uint32_t dma_base = 0x5000'0000, resets_base = 0x4000'c000,
                                 ram = 0x2000'0000;
  Timing timing;
  Bus bus{wheel, timing, not_modelled};
  PioDmaClock fabric{wheel, bus, gpio, irqs, timing, not_modelled};

  DmaSystemRig() {
    system.map(bus, gpio);
    bus.map(dma_base, fabric.dma());
    system.connect(fabric.dreqs());
    store(resets_base, 0);
    start_clocks();
    reports.clear();
  }
  void store(std::uint32_t address, std::uint32_t value) {
    bus.write(address, value, Width::word, Master::core0, wheel.now());
  }
  std::uint32_t load(std::uint32_t address) {
    return bus.read(address, Width::word, Master::core0, wheel.now()).value;
  }
  /// Starts clk_usb's PLL at 48 MHz, clk_adc from it, and clk_rtc from it at 46 875 Hz.
  void start_adc_and_rtc_clocks() {
    system.pll_usb.write(0x8, 100);
    system.pll_usb.write(0xc, 5u << 16 | 5u << 12);
    system.pll_usb.write(0x4, 0);
    pass_time(ps_per_ms);
    system.clocks.write(0x70, 1024u << 8);  // CLK_RTC_DIV
    system.clocks.write(0x6c, 1u << 11);    // CLK_RTC_CTRL
    system.clocks.write(0x60, 1u << 11);    // CLK_ADC_CTRL
  }
  /// Starts a DMA channel with words of 1 << `size` bytes, paced by a DREQ (2.5.7).
  void start_dma(unsigned channel, std::uint32_t from, std::uint32_t to, std::uint32_t count,
                 unsigned size, bool read_increments, bool write_increments, Dreq dreq) {
    const std::uint32_t at = dma_base + 0x40 * channel;
    store(at + 0x0, from);
    store(at + 0x4, to);
    store(at + 0x8, count);
    store(at + 0xc, 1u | size << 2 | (read_increments ? 1u << 4 : 0u) |
                        (write_increments ? 1u << 5 : 0u) | channel << 11 |
                        static_cast<unsigned>(dreq) << 15);
  }
  bool dma_busy(unsigned channel) {
    return (load(dma_base + 0x40 * channel + 0xc) >> 24 & 1u) != 0;
  }
};

}  // namespace lamplock::sim::chip::rigs
