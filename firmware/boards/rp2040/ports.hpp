// The two links, USB and UART, as one: the core talks with one host at a time. USB has two
// functions, of which it chooses one by its own rules (usb/listener.hpp).
//
// In:  bytes of both. Out: received bytes of the active port, commands of one byte first; answers
//      are sent to that port.
// Who: main loop.
//
// The port that sent last becomes the active one. While a job is unfinished the other one is
// ignored: two hosts at once would break each other's frames, and noise on an open line would
// attract the answers or, by a stray `~`, end a hold. Its bytes are discarded, real-time bytes too,
// however long the active port is silent: waiting does not distinguish noise from a host. The first
// bytes of the other port, and those after USB was reset, configured again or received over its
// other function, belong to a new connection: they must not complete half a line of the old one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lamplock::rp2040 {

/// `Usb` and `Uart` are UsbSerial and UartSerial, or a test's.
template <class Usb, class Uart>
class BasicPorts {
 public:
  explicit BasicPorts(unsigned uart_send_gpio) : uart_(uart_send_gpio) {}

  Usb& usb() { return usb_; }
  Uart& uart() { return uart_; }

  /// A command of one byte waits on either port.
  bool realtime_waits() const { return usb_.realtime_waits() || uart_.realtime_waits(); }
  /// Removes the oldest command of one byte; false if there is none. To be called before read().
  bool read_realtime(std::uint8_t& byte, bool tied) {
    return read_either(
               tied, [&byte](auto& port) { return port.read_realtime(byte) ? 1u : 0u; }, false) !=
           0;
  }
  /// Removes received bytes; returns how many. `tied`: only from the active port.
  std::size_t read(std::span<std::uint8_t> out, bool tied) {
    return read_either(tied, [out](auto& port) { return port.read(out); });
  }
  /// The bytes of the last read() were received before a byte that ends jogs (0x85, `!`, 0x84).
  bool before_jog_cancel() const {
    return on_uart_ ? uart_.before_jog_cancel() : usb_.before_jog_cancel();
  }
  /// True once after bytes of the UART were lost while it is active.
  bool take_loss() { return uart_.take_loss() && on_uart_; }
  /// The host of the active port is present. A host on the UART is assumed to be.
  bool host_present() const { return on_uart_ || usb_.present(); }
  /// True once for each new connection; to be called after each read(), before its bytes are used.
  bool take_new_connection() {
    const bool is_new = new_connection_;
    new_connection_ = false;
    return is_new;
  }
  /// Number of bytes that can be sent now, and sending them.
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
  template <class Read>
  std::size_t read_either(bool tied, Read&& read, bool of_connection = true) {
    usb_.set_tied(tied);
    if (const std::size_t n = read_from(usb_, false, tied, read, of_connection); n != 0) return n;
    return read_from(uart_, true, tied, read, of_connection);
  }

  /// `read` removes bytes of a port and returns how many; bytes `of_connection` are void if that
  /// has ended meanwhile, commands of one byte are not.
  template <class Port, class Read>
  std::size_t read_from(Port& port, bool is_uart, bool tied, Read&& read, bool of_connection) {
    std::uint32_t& seen = generations_[is_uart ? 1 : 0];
    const std::uint32_t generation = port.generation();
    if (generation != seen && on_uart_ == is_uart) new_connection_ = true;
    seen = generation;
    const std::size_t n = read(port);
    // The interrupt has ended the connection meanwhile: the bytes were its last. A host takes far
    // longer than this to send the first ones over a new one.
    if (n == 0 || (of_connection && port.generation() != generation)) return 0;
    if (on_uart_ == is_uart) return n;
    if (tied) return 0;
    on_uart_ = is_uart;
    new_connection_ = true;
    return n;
  }

  Usb usb_;
  Uart uart_;
  std::uint32_t generations_[2] = {};  ///< last value of USB and UART
  bool on_uart_ = false;
  bool new_connection_ = false;
};

}  // namespace lamplock::rp2040
