#include "host/flash/board_ports.hpp"

#include "host/access.hpp"
#include "host/error.hpp"
#include "host/flash/target.hpp"
#include "host/link/serial_transport.hpp"
#include "host/link/usb_serial_transport.hpp"

namespace lamplock::flash {

std::string SystemPorts::name(const usb::DeviceInfo& board) {
  const std::vector<std::string> ports = sysfs_.serial_ports(board.place);
  return ports.empty() ? "" : ports.front();
}

std::unique_ptr<link::Transport> SystemPorts::open(const usb::DeviceInfo& board) {
  const std::string port = name(board);
  if (port.empty())
    throw Error(Exit::no_device, name_of(board), "the system has made no serial port for it",
                "check that the kernel has the driver cdc_acm");
  if (const AccessProblem problem = access_problem(port))
    throw Error(Exit::no_device, port, problem.what, problem.remedy);
  return std::make_unique<link::SerialTransport>(port);
}

std::string DirectPorts::name(const usb::DeviceInfo& board) { return "USB " + board.place; }

std::unique_ptr<link::Transport> DirectPorts::open(const usb::DeviceInfo& board) {
  return std::make_unique<link::UsbSerialTransport>(bus_, board);
}

}  // namespace lamplock::flash
