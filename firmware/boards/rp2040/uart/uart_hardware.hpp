// The UART hardware for UartSerial: only register accesses (RP2040 datasheet, 4.2). A test gives
// UartSerial a substitute with the same members.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pads_bank0.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/uart.hpp"
#include "firmware/boards/rp2040/uart/uart_serial.hpp"

namespace lamplock::rp2040 {

/// UART whose TX is on a pin (datasheet, 1.4.3, table 2): pins 0, 12, 16 and 28 are UART 0's,
/// 4, 8, 20 and 24 UART 1's; RX is the next pin.
constexpr unsigned uart_of_pin(unsigned gpio) { return (gpio + 4) / 8 % 2; }
static_assert(uart_of_pin(0) == 0 && uart_of_pin(4) == 1 && uart_of_pin(8) == 1);
static_assert(uart_of_pin(12) == 0 && uart_of_pin(16) == 0 && uart_of_pin(20) == 1);
static_assert(uart_of_pin(24) == 1 && uart_of_pin(28) == 0);

class UartHardware {
 public:
  explicit UartHardware(unsigned send_gpio)
      : send_gpio_(send_gpio),
        number_(uart_of_pin(send_gpio)),
        registers_(uart_registers(uart_of_pin(send_gpio))) {}

  /// The interrupt to enable.
  Irq irq() const { return number_ == 0 ? Irq::uart0 : Irq::uart1; }

  /// Requires: clk_peri runs; IO_BANK0 and PADS_BANK0 are out of reset.
  void start(BaudDivisor divisor) {
    const std::uint32_t block = number_ == 0 ? reset_bit::uart0 : reset_bit::uart1;
    set_bits(resets().reset, block);
    release_reset(block);
    UartRegisters& uart = registers_;
    uart.ibrd = divisor.whole;
    uart.fbrd = divisor.fraction;
    // This write latches the divisor.
    uart.lcr_h = uart_field::eight_bits | uart_field::fifo_enable;
    uart.ifls = uart_field::send_below_eighth | uart_field::receive_from_quarter;
    uart.cr = uart_field::uart_enable | uart_field::send_enable | uart_field::receive_enable;
    // An open RX line must read as idle.
    constexpr std::uint32_t function = io_ctrl::function(io_ctrl::Function::uart);
    pads_bank0().gpio[send_gpio_ + 1] = pad::input_enable | pad::pull_up | pad::schmitt;
    io_bank0().gpio[send_gpio_ + 1].ctrl = function;
    io_bank0().gpio[send_gpio_].ctrl = function;
  }

  std::uint32_t flags() const { return registers_.fr; }
  std::uint32_t read_data() { return registers_.dr; }
  void write_data(std::uint8_t byte) { registers_.dr = byte; }
  void enable_interrupts(std::uint32_t bits) { registers_.imsc = bits; }
  void clear_interrupts(std::uint32_t bits) { registers_.icr = bits; }
  void pend() { nvic().ispr = irq_bit(irq()); }

 private:
  unsigned send_gpio_;
  unsigned number_;
  UartRegisters& registers_;
};

/// The port of the image, with its hardware.
class UartSerial : private UartHardware, public BasicUartSerial<UartHardware> {
 public:
  /// TX; RX is the next pin.
  explicit UartSerial(unsigned send_gpio)
      : UartHardware(send_gpio), BasicUartSerial<UartHardware>(static_cast<UartHardware&>(*this)) {}
  using BasicUartSerial<UartHardware>::start;
  using UartHardware::irq;
};

}  // namespace lamplock::rp2040
