// The system blocks of the chip, wired to each other (RP2040 datasheet, 2.12-2.23, 4.2-4.9).
//
// In:  the wheel, the pins, the interrupt lines, SIO.
// Out: clocks, resets, timer, watchdog, UARTs, PWM, SPI, I2C, ADC, RTC; a map of them for the bus;
//      the reset tree.
// Who: the chip, which attaches its own blocks to `resets` and `psm`.
#pragma once

#include <functional>

#include "sim/chip/analog/adc.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/serial/i2c.hpp"
#include "sim/chip/serial/spi.hpp"
#include "sim/chip/serial/uart.hpp"
#include "sim/chip/sio/sio.hpp"
#include "sim/chip/system/clocks.hpp"
#include "sim/chip/system/config.hpp"
#include "sim/chip/system/oscillators.hpp"
#include "sim/chip/system/power.hpp"
#include "sim/chip/system/pwm.hpp"
#include "sim/chip/system/resets.hpp"
#include "sim/chip/system/rtc.hpp"
#include "sim/chip/system/tick_generator.hpp"
#include "sim/chip/system/timer.hpp"
#include "sim/chip/system/watchdog.hpp"

namespace lamplock::sim::chip {

/// All system blocks. The chip attaches the other parts of the reset tree (PIO, DMA, USB, cores,
/// XIP): `bus.map(base, system.resets.attach(ResetBit::pio0, pio0))`,
/// `system.psm.attach(PsmBit::proc0, [](bool held) {...})`.
class System {
 public:
  struct Callbacks {
    std::function<void(int core, std::uint32_t irqs)> nmi_mask;  ///< SYSCFG PROCn_NMI_MASK
    std::function<void()> watchdog_fired;  ///< before anything is reset (to report); may be empty
  };
  System(TimeWheel& wheel, Gpio& gpio, Sio& sio, IrqLines& irqs, Callbacks callbacks,
         const NotModelled& not_modelled);
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  /// Puts all blocks, those of Gpio included, behind their resets and on the bus.
  void map(Bus& bus, Gpio& gpio);
  /// Lets the blocks with FIFOs request transfers of the DMA.
  void connect(DreqLines& lines);
  /// All causes alike: resets everything, the watchdog with its scratch registers included. All
  /// stages of `psm` are held and released.
  void reset(ChipReset cause);

  Xosc xosc;
  Rosc rosc;
  Pll pll_sys, pll_usb;
  FunctionPins clock_pins;
  Clocks clocks;
  TickGenerator ticks;
  Timer timer;
  Resets resets;
  Psm psm;
  VregAndChipReset vreg;
  Watchdog watchdog;
  Identification sysinfo;
  Syscfg syscfg;
  Identification tbman;
  Busctrl busctrl;
  FunctionPins uart_pins;
  Uart uart0, uart1;
  Pwm pwm;
  FunctionPins spi_pins;
  Spi spi0, spi1;
  FunctionPins i2c_pins;
  I2c i2c0, i2c1;
  Adc adc;
  Rtc rtc;

 private:
  void attach_stages(Sio& sio);
  void attach_gates();
};

}  // namespace lamplock::sim::chip
