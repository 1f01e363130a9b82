// The serial ports of a chip as a user sees them: UART0, UART1, and the CDC port on the USB.
//
// In:  bytes from the chip; bytes for it. Out: the same, each with its time.
// Who: scripts, which look for texts; programs that show a port on a terminal.
//
// Bytes of the UARTs arrive at the end of their frames. The USB host is polled by poll(): the time
// of its bytes is that of the call.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sim/chip/chip.hpp"
#include "sim/chip/script/script_time.hpp"
#include "sim/chip/usb_host/usb_host.hpp"

namespace lamplock::sim::chip::script {

/// All three; must live as long as the chip runs.
class SerialPorts {
 public:
  SerialPorts(Chip& chip, UsbHost& host);
  ~SerialPorts();
  SerialPorts(const SerialPorts&) = delete;
  SerialPorts& operator=(const SerialPorts&) = delete;

  /// Exchanges bytes with the USB host; those from it are of cycle `now`.
  void poll(Cycle now);
  /// The port is ready: for USB, enumerated.
  bool ready(Port port) const { return port != Port::usb || host_.enumerated(); }
  /// Sends bytes, after those of earlier calls.
  void send(Port port, std::string_view bytes);
  /// The USB host, or the line of the UART, has taken all bytes.
  bool sent(Port port) const { return port != Port::usb || to_host_.empty(); }

  /// Looks for a text in the port's output that no earlier call has used up; uses up everything to
  /// its end. Returns the time of its last byte.
  std::optional<Moment> find(Port port, std::string_view text);
  /// Bytes that the port has sent since power-up.
  std::uint64_t count(Port port) const { return heard_[static_cast<std::size_t>(port)].count; }
  /// The port's output that find() has not used up; of very much output only the end.
  std::string_view unused(Port port) const;
  /// The port's output since the last take(), for a terminal.
  std::string take(Port port);

 private:
  class Line;
  struct Heard {
    std::string unused;
    std::deque<Moment> times;  ///< of each byte of unused
    std::string to_take;
    std::uint64_t count = 0;
  };
  void heard(Port port, std::uint8_t byte, Cycle at);

  Chip& chip_;
  UsbHost& host_;
  std::array<Heard, port_count> heard_;
  std::array<std::unique_ptr<Line>, 2> lines_;
  std::string to_host_;
};

}  // namespace lamplock::sim::chip::script
