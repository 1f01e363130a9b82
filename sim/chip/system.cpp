#include "sim/chip/system.hpp"

#include <utility>

namespace lamplock::sim::chip {

System::System(TimeWheel& wheel, Gpio& gpio, Sio& sio, IrqLines& irqs, Callbacks callbacks,
               const NotModelled& not_modelled)
    : xosc(wheel, not_modelled),
      rosc(wheel, not_modelled),
      pll_sys("PLL_SYS", wheel, xosc, not_modelled),
      pll_usb("PLL_USB", wheel, xosc, not_modelled),
      clock_pins(gpio, PinFunction::clock, clock_signal),
      clocks(
          wheel, xosc, rosc, pll_sys, pll_usb, clock_pins, irqs,
          [this](ResetBit bit) { return resets.held(bit); }, not_modelled),
      ticks(wheel, clocks),
      timer(wheel, ticks, irqs, not_modelled),
      resets(not_modelled),
      psm(not_modelled),
      vreg(not_modelled),
      watchdog(wheel, ticks, not_modelled,
               [this, report = std::move(callbacks.watchdog_fired)] {
                 if (report) report();
                 psm.watchdog_hold();
                 resets.watchdog_fired();
                 psm.watchdog_release();
               }),
      sysinfo(Identification::sysinfo(not_modelled)),
      syscfg({std::move(callbacks.nmi_mask),
              [&sio](std::uint32_t pins) { sio.set_synchroniser_bypass(pins); }},
             not_modelled),
      tbman(Identification::tbman(not_modelled)),
      busctrl(not_modelled),
      uart_pins(gpio, PinFunction::uart, uart_signal),
      uart0(0, wheel, clocks, uart_pins, irqs, not_modelled),
      uart1(1, wheel, clocks, uart_pins, irqs, not_modelled),
      pwm(wheel, gpio, irqs, not_modelled),
      spi_pins(gpio, PinFunction::spi, spi_signal),
      spi0(0, wheel, clocks, spi_pins, irqs, not_modelled),
      spi1(1, wheel, clocks, spi_pins, irqs, not_modelled),
      i2c_pins(gpio, PinFunction::i2c, i2c_signal),
      i2c0(0, wheel, i2c_pins, irqs, not_modelled),
      i2c1(1, wheel, i2c_pins, irqs, not_modelled),
      adc(wheel, clocks, irqs, not_modelled),
      rtc(wheel, clocks, irqs, not_modelled) {
  attach_stages(sio);
  attach_gates();
}

void System::attach_stages(Sio& sio) {
  const auto reset_when_held = [](Peripheral& block) {
    return [&block](bool held) {
      if (held) block.reset();
    };
  };
  psm.attach(PsmBit::rosc, reset_when_held(rosc));
  psm.attach(PsmBit::xosc, reset_when_held(xosc));
  psm.attach(PsmBit::clocks, reset_when_held(clocks));
  psm.attach(PsmBit::resets, reset_when_held(resets));
  psm.attach(PsmBit::vreg_and_chip_reset, reset_when_held(vreg));
  psm.attach(PsmBit::sio, [&sio](bool held) {
    if (held) sio.reset();
  });
}

// Blocks with a clock of their own keep running without that of their registers (assumed).
void System::attach_gates() {
  const auto attach = [this](ClockGate gate, auto& block) {
    clocks.on_gate(gate, [&block](bool runs) { block.set_clock(runs); });
  };
  attach(ClockGate::adc_adc, adc);
  attach(ClockGate::rtc_rtc, rtc);
  attach(ClockGate::peri_spi0, spi0);
  attach(ClockGate::peri_spi1, spi1);
  attach(ClockGate::peri_uart0, uart0);
  attach(ClockGate::peri_uart1, uart1);
  attach(ClockGate::sys_watchdog, watchdog);
  const auto attach_registers = [this](ClockGate gate, ResetBit bit) {
    clocks.on_gate(gate, [this, bit](bool runs) { resets.set_clock(bit, runs); });
  };
  attach_registers(ClockGate::sys_adc, ResetBit::adc);
  attach_registers(ClockGate::sys_rtc, ResetBit::rtc);
  attach_registers(ClockGate::sys_spi0, ResetBit::spi0);
  attach_registers(ClockGate::sys_spi1, ResetBit::spi1);
  attach_registers(ClockGate::sys_uart0, ResetBit::uart0);
  attach_registers(ClockGate::sys_uart1, ResetBit::uart1);
  clocks.on_gate(ClockGate::sys_pwm, [this](bool runs) {
    resets.set_clock(ResetBit::pwm, runs);
    pwm.set_clock(runs);
  });
  clocks.on_gate(ClockGate::sys_timer, [this](bool runs) {
    resets.set_clock(ResetBit::timer, runs);
    timer.set_clock(runs);
  });
}

// Base addresses: RP2040 datasheet, 2.2.
void System::map(Bus& bus, Gpio& gpio) {
  bus.map(0x40000000, resets.attach(ResetBit::sysinfo, sysinfo));
  bus.map(0x40004000, resets.attach(ResetBit::syscfg, syscfg));
  bus.map(0x40008000, clocks);
  bus.map(0x4000c000, resets);
  bus.map(0x40010000, psm);
  bus.map(0x40014000, resets.attach(ResetBit::io_bank0, gpio.io_bank()));
  bus.map(0x4001c000, resets.attach(ResetBit::pads_bank0, gpio.pads_bank()));
  bus.map(0x40024000, xosc);
  bus.map(0x40028000, resets.attach(ResetBit::pll_sys, pll_sys));
  bus.map(0x4002c000, resets.attach(ResetBit::pll_usb, pll_usb));
  busctrl.connect(bus.arbiter());
  bus.map(0x40030000, resets.attach(ResetBit::busctrl, busctrl));
  bus.map(0x40034000, resets.attach(ResetBit::uart0, uart0));
  bus.map(0x40038000, resets.attach(ResetBit::uart1, uart1));
  bus.map(0x4003c000, resets.attach(ResetBit::spi0, spi0));
  bus.map(0x40040000, resets.attach(ResetBit::spi1, spi1));
  bus.map(0x40044000, resets.attach(ResetBit::i2c0, i2c0));
  bus.map(0x40048000, resets.attach(ResetBit::i2c1, i2c1));
  bus.map(0x4004c000, resets.attach(ResetBit::adc, adc));
  bus.map(0x40050000, resets.attach(ResetBit::pwm, pwm));
  bus.map(0x40054000, resets.attach(ResetBit::timer, timer));
  bus.map(0x40058000, watchdog);
  bus.map(0x4005c000, resets.attach(ResetBit::rtc, rtc));
  bus.map(0x40060000, rosc);
  bus.map(0x40064000, vreg);
  bus.map(0x4006c000, resets.attach(ResetBit::tbman, tbman));
}

void System::connect(DreqLines& lines) {
  uart0.connect(lines);
  uart1.connect(lines);
  pwm.connect(lines);
  spi0.connect(lines);
  spi1.connect(lines);
  i2c0.connect(lines);
  i2c1.connect(lines);
  adc.connect(lines);
}

void System::reset(ChipReset cause) {
  watchdog.reset();
  clocks.reset();  // before its sources stop
  psm.reset();
  psm.restart();
  vreg.note(cause);
}

}  // namespace lamplock::sim::chip
