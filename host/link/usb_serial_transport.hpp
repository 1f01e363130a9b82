// Drives the serial port of a board as an operating system's driver would: for the simulated bus,
// whose devices have no driver.
//
// In/out: bytes over the bulk endpoints of the CDC function (CDC 1.2; PSTN 1.2, 6.3.12).
// Who: flashing a simulated chip. On a real bus the kernel has these interfaces: SerialTransport.
#pragma once

#include <memory>

#include "host/link/transport.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::link {

class UsbSerialTransport final : public Transport {
 public:
  /// Opens the device, which must have a serial port, and asserts DTR; `bus` must outlive the
  /// transport. Throws Error(no_device).
  UsbSerialTransport(usb::Bus& bus, const usb::DeviceInfo& info);

  std::size_t write(std::span<const std::uint8_t> bytes) override { return stream_->write(bytes); }
  std::size_t read(std::span<std::uint8_t> bytes) override { return stream_->read(bytes); }
  void wait(std::chrono::microseconds time) override { stream_->wait(time); }
  std::chrono::microseconds now() const override { return bus_.now(); }
  bool connected() const override { return stream_->alive(); }
  bool reconnect() override { return false; }

 private:
  usb::Bus& bus_;
  std::unique_ptr<usb::Device> device_;
  std::unique_ptr<usb::Stream> stream_;
};

}  // namespace lamplock::link
