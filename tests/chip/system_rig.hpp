// A rig for tests of the system blocks: a wheel, pins, interrupt lines, all blocks, and a record of
// reports about unmodelled features.
//
// In:  nothing; out: the parts, wired as in the chip, without cores and bus.
// Used by the tests of the system blocks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/sio/sio.hpp"
#include "sim/chip/system.hpp"

namespace lamplock::sim::chip::rigs {

struct SystemRig {
  std::vector<std::string> reports;
  NotModelled not_modelled = [this](const std::string& what) { reports.push_back(what); };
  TimeWheel wheel;
  IrqLines irqs;
  Gpio gpio{wheel, irqs, not_modelled};
  Sio sio{wheel, gpio, irqs, [] { return 2u; }, not_modelled};
  System system{wheel, gpio, sio, irqs, {}, not_modelled};

  bool line(Irq irq, int core = 0) const {
    return (irqs.levels(core) >> static_cast<unsigned>(irq) & 1u) != 0;
  }
  void connect(unsigned pin, PinFunction function, std::uint32_t overrides = 0) {
    gpio.io_bank().write(8 * pin + 4, static_cast<std::uint32_t>(function) | overrides);
  }
  bool pad(unsigned pin) const { return (gpio.pad_levels() >> pin & 1u) != 0; }
  /// A level from outside.
  void drive(unsigned pin, bool level) {
    gpio.set_external(pin, level ? External::high : External::low, wheel.now());
  }
  void pass(Cycle cycles) { wheel.advance_to(wheel.now() + cycles); }
  void pass_time(Picoseconds time) { wheel.advance_to(wheel.cycle_at(wheel.time() + time)); }
  /// The usual start: crystal, PLL_SYS at 125 MHz, clk_ref from the crystal, 1 us ticks, clk_peri.
  void start_clocks() {
    system.xosc.write(0xc, 1);
    system.xosc.write(0x0, 0xfabaa0);
    pass_time(ps_per_ms);
    system.pll_sys.write(0x8, 125);
    system.pll_sys.write(0xc, 6u << 16 | 2u << 12);
    system.pll_sys.write(0x4, 0);
    pass_time(ps_per_ms);
    system.clocks.write(0x30, 2);  // clk_ref: crystal
    pass(10);
    system.clocks.write(0x3c, 1);  // clk_sys: auxiliary, PLL_SYS
    pass(10);
    system.clocks.write(0x48, 1u << 11);
    system.watchdog.write(0x2c, 12 | 1u << 9);
  }
};

}  // namespace lamplock::sim::chip::rigs
