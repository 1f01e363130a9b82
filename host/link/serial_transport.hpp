// A serial port: the board's USB, a USB adapter, or a pseudo-terminal of `lamplock sim`.
#pragma once

#include <memory>
#include <string>

#include "host/error.hpp"
#include "host/link/descriptor_transport.hpp"
#include "shared/boards/pico_uart.hpp"

namespace lamplock::link {

/// The error about a port that does not exist: no_device, with ports of a similar name.
Error missing_port(const std::string& port);

/// Opens a port raw, 8N1, without flow control. Opening it does not drop DTR, by which some boards
/// are reset; closing it does on the USB of a lamplock board alone, which holds its machine then.
class SerialTransport : public DescriptorTransport {
 public:
  /// Matters for adapters at the board's UART only; USB and pseudo-terminals ignore it.
  static constexpr unsigned default_baud = boards::uart_baud;

  /// Throws Error(no_device) if the port cannot be opened.
  explicit SerialTransport(std::string port, unsigned baud = default_baud);
  ~SerialTransport() override;
  SerialTransport(const SerialTransport&) = delete;
  SerialTransport& operator=(const SerialTransport&) = delete;

 protected:
  bool open() override;
  void close() override;
  int descriptor() override;

 private:
  struct Port;
  std::unique_ptr<Port> port_;
};

}  // namespace lamplock::link
