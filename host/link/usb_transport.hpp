// The pulse stream's own interface of a board: two bulk endpoints on USB, no driver between.
//
// In/out: bytes, the same as over the serial port (docs/wire-format.md). Who: commands that open a
// board by name (host/cli).
//
// A board is identified by its serial number: after it was plugged in again, at any USB port, its
// job continues. Bytes for an earlier program are discarded when the interface is opened, as in
// SerialTransport.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/link/transport.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::link {

/// USB interface of a board's pulse stream.
struct StreamInterface {
  std::uint8_t number = 0;
  std::uint8_t out = 0, in = 0;  ///< addresses of its endpoints
};

/// The vendor interface with one bulk endpoint each way; none in old firmware.
std::optional<StreamInterface> stream_interface(const usb::DeviceInfo& device);

/// Every board that runs lamplock, by place.
std::vector<usb::DeviceInfo> find_boards(usb::Bus& bus);

/// The board with this serial number; the only one, if none is given. Throws Error: no_device if
/// there is none, bad_input with the serial numbers if there are several.
usb::DeviceInfo find_board(usb::Bus& bus, const std::string& serial);

/// One board's pulse stream.
class UsbTransport final : public Transport {
 public:
  /// `board`: from find_board(). Throws Error(no_device), with the remedy, if its interface may not
  /// be opened, is in use by another program, or does not exist.
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
  std::string serial_;  ///< of the board
  std::unique_ptr<usb::Device> device_;
  std::unique_ptr<usb::Stream> stream_;  ///< of device_, destroyed before it
};

}  // namespace lamplock::link
