// The two links, USB and UART, as one: the core talks with one host at a time.
//
// In:  bytes of both. Out: bytes of the one that is being listened to; answers go there.
// Who: main loop.
//
// Whoever speaks is listened to. While a job runs the other one is not: two hosts at once would
// break each other's frames. What it says is thrown away, real-time bytes too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/boards/rp2040/uart/uart_hardware.hpp"
#include "firmware/boards/rp2040/usb/usb_hardware.hpp"

namespace lamplock::rp2040 {

class Ports {
 public:
  explicit Ports(unsigned uart_send_gpio) : uart_(uart_send_gpio) {}

  UsbSerial& usb() { return usb_; }
  UartSerial& uart() { return uart_; }

  /// Takes received bytes; returns how many. `tied`: only from the one listened to last.
  std::size_t read(std::span<std::uint8_t> out, bool tied) {
    if (const std::size_t n = read_from(usb_, false, out, tied); n != 0) return n;
    return read_from(uart_, true, out, tied);
  }
  /// How many bytes can be sent now, and sending them.
  std::size_t room() const { return on_uart_ ? uart_.room() : usb_.room(); }
  void write(std::span<const std::uint8_t> bytes) {
    if (on_uart_)
      uart_.write(bytes);
    else
      usb_.write(bytes);
  }
  void poll() {
    usb_.poll();
    uart_.poll();
  }

 private:
  template <class Port>
  std::size_t read_from(Port& port, bool is_uart, std::span<std::uint8_t> out, bool tied) {
    const std::size_t n = port.read(out);
    if (n == 0 || on_uart_ == is_uart) return n;
    if (tied) return 0;
    on_uart_ = is_uart;
    return n;
  }

  UsbSerial usb_;
  UartSerial uart_;
  bool on_uart_ = false;
};

}  // namespace lamplock::rp2040
