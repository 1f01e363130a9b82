// Clocks from the 12 MHz crystal: clk_ref 12 MHz, clk_sys and clk_peri 125 MHz (or 200 MHz, with
// the core at 1.15 V), clk_usb 48 MHz, ticks of 1 us for watchdog and timer. Runs in the loader,
// hence inline and without calls.
#pragma once

#include "firmware/boards/rp2040/registers/clocks.hpp"
#include "firmware/boards/rp2040/registers/pll.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/vreg.hpp"
#include "firmware/boards/rp2040/registers/watchdog.hpp"
#include "firmware/boards/rp2040/registers/xosc.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

inline constexpr std::uint32_t crystal_hz = 12'000'000;

/// One PLL: crystal * feedback / (postdiv1 * postdiv2), VCO within 750-1600 MHz
/// (datasheet, 2.18.2).
struct PllSetting {
  std::uint32_t feedback, postdiv1, postdiv2;
  constexpr std::uint32_t vco_hz() const { return crystal_hz * feedback; }
  constexpr std::uint32_t output_hz() const { return vco_hz() / (postdiv1 * postdiv2); }
};
inline constexpr PllSetting sys_setting =
    clock_hz == 200'000'000 ? PllSetting{100, 6, 1} : PllSetting{125, 6, 2};
inline constexpr PllSetting usb_setting{100, 5, 5};
static_assert(sys_setting.vco_hz() >= 750'000'000 && sys_setting.vco_hz() <= 1'600'000'000);
static_assert(sys_setting.output_hz() == clock_hz, "no setting of the PLL for this clock");
static_assert(usb_setting.vco_hz() == 1'200'000'000 && usb_setting.output_hz() == 48'000'000);

/// Starts the crystal oscillator with a delay of 1 ms (datasheet, 2.16.3), counted in 256 clocks.
[[gnu::always_inline]] inline void start_crystal() {
  xosc().startup = (crystal_hz / 1000 + 128) / 256;
  xosc().ctrl = xosc_field::enable | xosc_field::freq_range_1_15_mhz;
  while ((xosc().status & xosc_field::stable) == 0) {
  }
}

/// In the order of the datasheet, 2.18.3: VCO, lock, post dividers.
[[gnu::always_inline]] inline void start_pll(PllRegisters& pll, std::uint32_t reset,
                                             const PllSetting& setting) {
  set_bits(resets().reset, reset);
  release_reset(reset);
  pll.cs = 1;  // crystal undivided
  pll.fbdiv_int = setting.feedback;
  clear_bits(pll.pwr, pll_field::power_down | pll_field::vco_down);
  while ((pll.cs & pll_field::lock) == 0) {
  }
  pll.prim = (setting.postdiv1 << pll_field::postdiv1_shift) |
             (setting.postdiv2 << pll_field::postdiv2_shift);
  clear_bits(pll.pwr, pll_field::postdiv_down);
}

/// Up to this clock the voltage after a reset, 1.10 V, is enough; 200 MHz needs 1.15 V (datasheet,
/// table of clk_sys; Raspberry Pi's SDK 2.1.1, which allows 200 MHz, waits 1 ms for it).
inline constexpr std::uint32_t max_clock_at_reset_voltage_hz = 133'000'000;

/// Raises the voltage of the core where the clock needs it. clk_sys is clk_ref.
[[gnu::always_inline]] inline void set_core_voltage() {
  if constexpr (clock_hz > max_clock_at_reset_voltage_hz) {
    Register& vreg = vreg_and_chip_reset().vreg;
    vreg = (vreg & ~vreg_field::voltage_mask) | vreg_field::voltage_1_15;
    while ((vreg & vreg_field::in_regulation) == 0) {
    }
    // A round takes three clocks at least.
    for (std::uint32_t rounds = crystal_hz / 1000 / 3; rounds != 0; --rounds) asm volatile("");
  }
}

/// Switches a glitchless multiplexer and waits until it has switched.
[[gnu::always_inline]] inline void select_source(ClockGenerator& generator, std::uint32_t source) {
  generator.ctrl = (generator.ctrl & ~3u) | source;
  while (generator.selected != 1u << source) {
  }
}

[[gnu::always_inline]] inline void start_clocks() {
  ClocksRegisters& c = clocks();
  c.sys_resus_ctrl = 0;
  start_crystal();
  // clk_sys leaves the PLLs before they are changed.
  select_source(c.sys, clock_field::sys_source_ref);
  c.ref.div = clock_field::divide_by_1;
  select_source(c.ref, clock_field::ref_source_xosc);
  set_core_voltage();
  start_pll(pll_sys(), reset_bit::pll_sys, sys_setting);
  start_pll(pll_usb(), reset_bit::pll_usb, usb_setting);
  c.sys.div = clock_field::divide_by_1;
  c.sys.ctrl = clock_field::sys_aux_pll_sys | clock_field::sys_source_ref;
  select_source(c.sys, clock_field::sys_source_aux);
  c.usb.ctrl = clock_field::usb_aux_pll_usb;
  c.usb.div = clock_field::divide_by_1;
  c.usb.ctrl = clock_field::usb_aux_pll_usb | clock_field::enable;
  c.peri.ctrl = clock_field::peri_aux_sys | clock_field::enable;
  watchdog_registers().tick = watchdog_field::tick_enable | (crystal_hz / 1'000'000);
}

}  // namespace lamplock::rp2040
