#include "sim/chip/profile/exception_name.hpp"

#include <array>

#include "sim/chip/fabric/irq_lines.hpp"

namespace lamplock::sim::chip {

std::string exception_name(unsigned number) {
  // Numbers of the exceptions: ARMv6-M ARM, B1.5.2; lines of the RP2040 from 16 on (2.3.2).
  constexpr std::array<const char*, irq_line_count> lines = {
      "TIMER_0", "TIMER_1", "TIMER_2", "TIMER_3", "PWM_WRAP", "USBCTRL", "XIP",
      "PIO0_0",  "PIO0_1",  "PIO1_0",  "PIO1_1",  "DMA_0",    "DMA_1",   "IO_BANK0",
      "IO_QSPI", "SIO_0",   "SIO_1",   "CLOCKS",  "SPI0",     "SPI1",    "UART0",
      "UART1",   "ADC",     "I2C0",    "I2C1",    "RTC"};
  switch (number) {
    case 2:
      return "NMI";
    case 3:
      return "HardFault";
    case 11:
      return "SVCall";
    case 14:
      return "PendSV";
    case 15:
      return "SysTick";
    default:
      break;
  }
  if (number >= 16 && number - 16 < lines.size()) return lines[number - 16];
  return "exception " + std::to_string(number);
}

}  // namespace lamplock::sim::chip
