// The UART of the drives: UART1, both directions on one wire, without interrupts: a datagram and
// its answer fit into the FIFOs (RP2040 datasheet, 4.2).
//
// Who: DriveSetup. start() after the pads have been checked: RX is pulled up, so that a wire
// without drives is idle.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/uart/uart_hardware.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

class DriveUart {
 public:
  /// The drives find the rate by themselves, up to a sixteenth of their 12 MHz.
  static constexpr std::uint32_t baud = 115'200;

  explicit DriveUart(unsigned send_gpio) : hardware_(send_gpio) {}
  [[gnu::cold]] void start() { hardware_.start(BaudDivisor::of(clock_hz, baud)); }
  /// A byte, with an error of its frame in the bits above; -1: none has come.
  int read() {
    if ((hardware_.flags() & uart_field::flag_receive_empty) != 0) return -1;
    return static_cast<int>(hardware_.read_data());
  }
  void write(std::uint8_t byte) { hardware_.write_data(byte); }

 private:
  UartHardware hardware_;
};

}  // namespace lamplock::rp2040
