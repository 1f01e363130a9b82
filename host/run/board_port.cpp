#include "host/run/board_port.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "host/error.hpp"
#include "host/link/serial_transport.hpp"
#include "host/link/tcp_transport.hpp"
#include "host/link/usb_transport.hpp"
#include "host/remark.hpp"
#include "host/run/board_names.hpp"
#include "host/usb/libusb_bus.hpp"
#include "host/usb/sysfs.hpp"
#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::run {
namespace {

/// The pulse stream needs a permission that a serial port may have already. One that another
/// program has is an error: that program may be in the middle of a job.
std::unique_ptr<link::Transport> open_any() {
  const auto bus = std::make_shared<usb::LibusbBus>();
  const usb::DeviceInfo board = link::find_board(*bus, "");
  try {
    auto stream = std::make_unique<link::UsbTransport>(bus, board);
    write_remark(fmt::format("board {} (USB {}): talking over its pulse stream\n", board.serial,
                             board.place));
    return stream;
  } catch (const Error& error) {
    const auto ports = usb::Sysfs().serial_ports(board.place);
    const bool in_use = board.problem.empty() && link::stream_interface(board);
    if (ports.empty() || in_use) throw;
    auto port = std::make_unique<link::SerialTransport>(ports.front());
    write_remark(
        fmt::format("warning: {}; talking over {} meanwhile\n", error.message(), ports.front()));
    return port;
  }
}

}  // namespace

std::optional<std::string> usb_serial(const std::string& board) {
  const std::string prefix = std::string(usb_board) + ":";
  if (board == usb_board) return "";
  if (board.starts_with(prefix)) return board.substr(prefix.size());
  return std::nullopt;
}

namespace {

std::unique_ptr<link::Transport> open_named(const std::string& board, unsigned baud) {
  if (board == auto_board) return open_any();
  if (const auto serial = usb_serial(board)) {
    const auto bus = std::make_shared<usb::LibusbBus>();
    return std::make_unique<link::UsbTransport>(bus, link::find_board(*bus, *serial));
  }
  const bool path = board.find('/') != std::string::npos;
  if (!path && sim::parse_tcp_address(board)) return std::make_unique<link::TcpTransport>(board);
  return std::make_unique<link::SerialTransport>(board, baud);
}

}  // namespace

std::unique_ptr<link::Transport> open_board(const std::string& board, unsigned baud) {
  check_board_name(board);
  auto transport = open_named(board, baud);
  transport->set_board(board);
  return transport;
}

void check_is_connected(const BoardOptions& options) {
  const std::string& board = options.board;
  if (options.is_simulated() || options.opener) return;
  const auto serial = usb_serial(board);
  if (board == auto_board || serial) {
    usb::LibusbBus bus;
    link::find_board(bus, serial.value_or(""));
  } else if (std::error_code ignored;
             board.find('/') != std::string::npos && !std::filesystem::exists(board, ignored)) {
    throw link::missing_port(board);
  }
}

std::unique_ptr<link::Transport> open_port(const BoardOptions& options) {
  if (options.opener) return options.opener();
  return options.is_simulated() ? nullptr : open_board(options.board, options.baud);
}

}  // namespace lamplock::run
