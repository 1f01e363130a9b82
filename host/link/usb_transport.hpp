// The pulse stream's own interface of a board: two bulk endpoints on USB, no driver between.
//
// In/out: bytes, the same as over the serial port (docs/wire-format.md). Who: whoever has opened a
// board by name (host/cli).
//
// A board is known by its serial number: plugged in again, at whatever place, it is the same one
// and a job goes on. Bytes that the board has left from a program before are thrown away when the
// interface is opened, as SerialTransport does.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/link/transport.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::link {

/// Where a board's pulse stream is.
struct StreamInterface {
  std::uint8_t number = 0;
  std::uint8_t out = 0, in = 0;  ///< addresses of its endpoints
};

/// The vendor interface with one bulk endpoint each way; none in old firmware.
std::optional<StreamInterface> stream_interface(const usb::DeviceInfo& device);

/// Every board that runs lamplock, by place.
std::vector<usb::DeviceInfo> find_boards(usb::Bus& bus);

/// The board with this serial number; the only one, if none is given. Throws Error: no_device if
/// there is none, bad_input if there are several to choose from, with their numbers.
usb::DeviceInfo find_board(usb::Bus& bus, const std::string& serial);

/// One board's pulse stream.
class UsbTransport final : public Transport {
 public:
  /// `board`: as find_board() gives it. Throws Error(no_device), with the remedy, if its interface
  /// may not be opened, another program has it, or there is none.
  UsbTransport(std::shared_ptr<usb::Bus> bus, const usb::DeviceInfo& board);
  ~UsbTransport() override;
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;

  std::size_t write(std::span<const std::uint8_t> bytes) override;
  std::size_t read(std::span<std::uint8_t> bytes) override;
  void wait(std::chrono::microseconds time) override;
  std::chrono::microseconds now() const override;
  bool connected() const override;
  bool reconnect() override;

 private:
  void open(const usb::DeviceInfo& board);
  void drain();

  std::shared_ptr<usb::Bus> bus_;
  std::string serial_;  ///< which board it is
  std::unique_ptr<usb::Device> device_;
  std::unique_ptr<usb::Stream> stream_;  ///< of device_, gone before it
};

}  // namespace lamplock::link
