#include "host/link/usb_transport.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "host/error.hpp"
#include "host/usb/known_devices.hpp"

namespace lamplock::link {
namespace {

using std::chrono::milliseconds;

/// Bytes for an earlier program arrive within a frame or two of 1 ms.
constexpr milliseconds leftover_wait{5};
/// More than a board buffers: ring of 2 KiB, buffers of the core and of the endpoint.
constexpr std::size_t max_leftovers = 16384;

std::string name_of(const usb::DeviceInfo& board) {
  return fmt::format("board {} (USB {})", board.serial, board.place);
}

std::string serials_of(const std::vector<usb::DeviceInfo>& boards) {
  std::string text;
  for (const usb::DeviceInfo& board : boards)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", board.serial);
  return text;
}

}  // namespace

std::optional<StreamInterface> stream_interface(const usb::DeviceInfo& device) {
  for (const usb::Interface& interface : device.interfaces) {
    if (interface.class_code != usb::vendor_specific) continue;
    StreamInterface found{interface.number};
    for (const usb::Endpoint& endpoint : interface.endpoints) {
      if (endpoint.kind != usb::Endpoint::Kind::bulk) continue;
      const bool in = (endpoint.address & usb::direction_in) != 0;
      (in ? found.in : found.out) = endpoint.address;
    }
    if (found.in != 0 && found.out != 0) return found;
  }
  return std::nullopt;
}

std::vector<usb::DeviceInfo> find_boards(usb::Bus& bus) {
  std::vector<usb::DeviceInfo> boards = bus.devices();
  std::erase_if(boards, [](const usb::DeviceInfo& device) {
    return usb::known_device(device).kind != usb::Kind::board;
  });
  return boards;
}

usb::DeviceInfo find_board(usb::Bus& bus, const std::string& serial) {
  const std::vector<usb::DeviceInfo> boards = find_boards(bus);
  if (boards.empty())
    throw Error(Exit::no_device, "USB", "there is no board that runs lamplock",
                "plug it in, or flash it: lamplock flash");
  if (serial.empty() && boards.size() > 1)
    throw Error(Exit::bad_input, "USB",
                fmt::format("{} boards are connected: {}", boards.size(), serials_of(boards)),
                "choose one: --board usb:SERIAL");
  const auto found = std::find_if(boards.begin(), boards.end(), [&](const usb::DeviceInfo& board) {
    return serial.empty() || board.serial == serial;
  });
  if (found == boards.end())
    throw Error(Exit::no_device, "USB", fmt::format("there is no board {}", serial),
                fmt::format("use one of these: {}", serials_of(boards)));
  return *found;
}

UsbTransport::UsbTransport(std::shared_ptr<usb::Bus> bus, const usb::DeviceInfo& board)
    : bus_(std::move(bus)), serial_(board.serial) {
  open(board);
}

UsbTransport::~UsbTransport() = default;

void UsbTransport::open(const usb::DeviceInfo& board) {
  const std::optional<StreamInterface> interface = stream_interface(board);
  if (!interface)
    throw Error(Exit::no_device, name_of(board), "its firmware has no pulse stream interface",
                "flash it again (lamplock flash), or use its serial port");
  device_ = bus_->open(board);
  if (const usb::TransferEnd end = device_->claim(interface->number);
      end != usb::TransferEnd::done) {
    device_.reset();
    if (end == usb::TransferEnd::gone)
      throw Error(Exit::no_device, name_of(board), "was unplugged", "plug it in again");
    throw Error(Exit::no_device, name_of(board), "another program uses its pulse stream interface",
                "close that program, or use the serial port");
  }
  stream_ = device_->stream(interface->out, interface->in);
  drain();
}

void UsbTransport::drain() {
  std::array<std::uint8_t, 1024> bytes{};
  for (std::size_t drained = 0; drained < max_leftovers;) {
    stream_->wait(leftover_wait);
    const std::size_t count = stream_->read(bytes);
    if (count == 0) return;
    drained += count;
  }
}

std::size_t UsbTransport::write(std::span<const std::uint8_t> bytes) {
  return connected() && !bytes.empty() ? stream_->write(bytes) : 0;
}

std::size_t UsbTransport::read(std::span<std::uint8_t> bytes) {
  return stream_ ? stream_->read(bytes) : 0;  // also bytes received before it was unplugged
}

void UsbTransport::wait(std::chrono::microseconds time) {
  if (connected())
    stream_->wait(time);
  else
    bus_->sleep(std::chrono::ceil<milliseconds>(time));
}

std::chrono::microseconds UsbTransport::now() const { return bus_->now(); }

bool UsbTransport::connected() const { return stream_ && stream_->alive(); }

bool UsbTransport::reconnect() {
  stream_.reset();
  device_.reset();
  for (const usb::DeviceInfo& board : find_boards(*bus_)) {
    if (board.serial != serial_) continue;
    try {
      open(board);
      return connected();
    } catch (const Error&) {
      return false;  // not yet: it may still be setting up
    }
  }
  return false;
}

}  // namespace lamplock::link
