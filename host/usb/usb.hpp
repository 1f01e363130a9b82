// USB devices as a program sees them: what is plugged in, and transfers to one of them.
//
// In:  requests. Out: descriptors, bytes, and what became of each transfer as a value: a transfer
//      that fails is an ordinary event (a cable is pulled), so that only open() throws.
// Who: flashing (host/flash), the list of devices, the link over a vendor interface. Two things
//      stand behind it: libusb (libusb_bus.hpp), and the simulated chip (simulated_usb.hpp).
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

/// A device that is plugged in.
struct DeviceInfo {
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t version_bcd = 0;
  std::string place{};  ///< bus and ports, "1-4.2": stays the same over a restart of the device
  std::vector<Interface> interfaces{};
  std::string manufacturer{}, name{}, serial{};  ///< empty if it has none or may not be opened
  std::string problem{};                         ///< why it may not be opened, with the remedy
};

/// What became of a transfer.
enum class TransferEnd : std::uint8_t {
  done,
  timed_out,
  stalled,   ///< the device refuses; of a bulk endpoint: until clear_halt()
  gone,      ///< unplugged, or restarted
  overflow,  ///< the device sent more than was asked for
  failed
};

/// `size`: bytes moved, also of one that was not done.
struct Transfer {
  TransferEnd end = TransferEnd::done;
  std::size_t size = 0;
  bool done() const { return end == TransferEnd::done; }
};

/// A control request (USB 2.0, table 9-2); its length is that of the data.
struct Setup {
  std::uint8_t type = 0;  ///< direction_in: the data come from the device
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// A way for a stream of bytes over one bulk endpoint each way, never waiting: transfers to come
/// are queued ahead, so that the bus is kept busy while the program does something else.
class Stream {
 public:
  virtual ~Stream() = default;
  /// Takes as much as there is room for; returns how many bytes. 0 if the device is gone.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
  /// Gives what has come; returns how many bytes.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;
  /// Until something can be read, or `time` is over, or the device is gone.
  virtual void wait(std::chrono::microseconds time) = 0;
  /// False once the device is gone or an endpoint has failed.
  virtual bool alive() const = 0;
};

/// An open device; closed with the object, its interfaces given back.
class Device {
 public:
  virtual ~Device() = default;

  /// Wants an interface for itself; done, or failed if another program or driver has it.
  virtual TransferEnd claim(std::uint8_t interface_number) = 0;
  virtual Transfer control(const Setup& setup, std::span<std::uint8_t> data,
                           std::chrono::milliseconds time) = 0;
  /// An empty transfer is one empty packet.
  virtual Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                            std::chrono::milliseconds time) = 0;
  /// Until the span is full, or a short packet.
  virtual Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                           std::chrono::milliseconds time) = 0;
  virtual TransferEnd clear_halt(std::uint8_t endpoint) = 0;
  /// A stream over two bulk endpoints of a claimed interface; must not outlive the device, and
  /// nobody else uses these endpoints meanwhile.
  virtual std::unique_ptr<Stream> stream(std::uint8_t out_endpoint, std::uint8_t in_endpoint) = 0;
};

/// What is plugged in.
class Bus {
 public:
  virtual ~Bus() = default;
  /// Every device, by place. Devices that may not be opened are there, with their problem.
  virtual std::vector<DeviceInfo> devices() = 0;
  /// Throws Error(no_device), with the remedy, if it is gone or may not be opened.
  virtual std::unique_ptr<Device> open(const DeviceInfo& device) = 0;
  /// Time passes: real time, or simulated time of a simulated device.
  virtual void sleep(std::chrono::milliseconds time) = 0;
  /// Time since some moment, as sleep() counts it.
  virtual std::chrono::milliseconds now() = 0;
};

}  // namespace lamplock::usb
