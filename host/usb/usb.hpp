// Interface to USB devices: a list of connected ones, and transfers.
//
// In:  requests. Out: descriptors, bytes, and the result of each transfer as a value: a failed
//      transfer is an ordinary event (a cable is pulled), so that only open() throws.
// Who: flashing (host/flash), the list of devices, the link over a vendor interface. Implemented
//      with libusb (libusb_bus.hpp), and for the simulated chip (simulated_usb.hpp).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lamplock::usb {

inline constexpr std::uint8_t direction_in = 0x80;  ///< in an endpoint's address, a request's type
inline constexpr std::uint8_t vendor_specific = 0xff;  ///< interface class

/// One endpoint (USB 2.0, table 9-13).
struct Endpoint {
  enum class Kind : std::uint8_t { control, isochronous, bulk, interrupt };
  std::uint8_t address = 0;  ///< with direction_in
  Kind kind = Kind::bulk;
  std::uint16_t packet_size = 64;

  bool operator==(const Endpoint&) const = default;
};

/// One interface in its first alternate setting (USB 2.0, table 9-12).
struct Interface {
  std::uint8_t number = 0;
  std::uint8_t class_code = 0, subclass = 0, protocol = 0;
  std::vector<Endpoint> endpoints{};

  bool operator==(const Interface&) const = default;
};

/// A connected device.
struct DeviceInfo {
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t version_bcd = 0;
  std::string place{};  ///< bus and ports, "1-4.2": stays the same over a restart of the device
  std::vector<Interface> interfaces{};
  std::string manufacturer{}, name{}, serial{};  ///< empty if it has none or may not be opened
  std::string problem{};                         ///< why it may not be opened, with the remedy
};

/// Result of a transfer.
enum class TransferEnd : std::uint8_t {
  done,
  timed_out,
  stalled,   ///< the device refuses; of a bulk endpoint: until clear_halt()
  gone,      ///< unplugged, or restarted
  overflow,  ///< the device sent more than requested
  failed
};

/// `size`: bytes moved, also by a transfer that failed.
struct Transfer {
  TransferEnd end = TransferEnd::done;
  std::size_t size = 0;
  bool done() const { return end == TransferEnd::done; }
};

/// A control request (USB 2.0, table 9-2); its length is that of the data.
struct Setup {
  std::uint8_t type = 0;  ///< direction_in: data from the device
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// A stream of bytes over one bulk endpoint each way, without blocking: transfers are queued ahead,
/// so that the bus works while the program does other work.
class Stream {
 public:
  virtual ~Stream() = default;
  /// Accepts as many bytes as there is room for; returns their number, 0 if the device is
  /// unplugged.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
  /// Reads received bytes; returns their number.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;
  /// Waits until bytes can be read, or `time` has passed, or the device is unplugged.
  virtual void wait(std::chrono::microseconds time) = 0;
  /// False once the device is unplugged or an endpoint has failed.
  virtual bool alive() const = 0;
};

/// An open device; closed with the object, which releases its interfaces.
class Device {
 public:
  virtual ~Device() = default;

  /// Claims an interface; done, or failed if another program or driver has it.
  virtual TransferEnd claim(std::uint8_t interface_number) = 0;
  virtual Transfer control(const Setup& setup, std::span<std::uint8_t> data,
                           std::chrono::milliseconds time) = 0;
  /// An empty transfer is one empty packet.
  virtual Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                            std::chrono::milliseconds time) = 0;
  /// Reads until the span is full, or a short packet.
  virtual Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                           std::chrono::milliseconds time) = 0;
  virtual TransferEnd clear_halt(std::uint8_t endpoint) = 0;
  /// A stream over two bulk endpoints of a claimed interface; must not outlive the device, and no
  /// other transfer may use these endpoints meanwhile.
  virtual std::unique_ptr<Stream> stream(std::uint8_t out_endpoint, std::uint8_t in_endpoint) = 0;
};

/// The connected devices.
class Bus {
 public:
  virtual ~Bus() = default;
  /// Every device, by place. Devices that may not be opened are listed with their problem.
  virtual std::vector<DeviceInfo> devices() = 0;
  /// Throws Error(no_device), with the remedy, if the device is unplugged or may not be opened.
  virtual std::unique_ptr<Device> open(const DeviceInfo& device) = 0;
  /// Waits in real time, or in simulated time of a simulated device.
  virtual void sleep(std::chrono::milliseconds time) = 0;
  /// Time since a fixed moment, on the clock of sleep().
  virtual std::chrono::milliseconds now() = 0;
};

}  // namespace lamplock::usb
