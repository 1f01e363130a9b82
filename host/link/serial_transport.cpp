#include "host/link/serial_transport.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <utility>

#include "host/access.hpp"
#include "host/error.hpp"

namespace lamplock::link {
namespace asio = boost::asio;

struct SerialTransport::Port {
  Port(std::string name_in, unsigned baud_in) : name(std::move(name_in)), baud(baud_in) {}
  std::string name;
  unsigned baud;
  asio::io_context context;
  asio::serial_port port{context};
  boost::system::error_code failure;
};

namespace {

/// Closing the port must not drop DTR: some boards take that for a reset.
void keep_lines_on_close(int descriptor) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  settings.c_cflag |= CLOCAL;
  ::tcsetattr(descriptor, TCSANOW, &settings);
}

/// Asks the driver not to collect bytes for milliseconds; USB and pseudo-terminals know nothing
/// of it and need not.
void ask_low_latency(int descriptor) {
  serial_struct driver{};
  if (::ioctl(descriptor, TIOCGSERIAL, &driver) != 0) return;
  driver.flags = static_cast<int>(static_cast<unsigned>(driver.flags) | ASYNC_LOW_LATENCY);
  ::ioctl(descriptor, TIOCSSERIAL, &driver);
}

}  // namespace

SerialTransport::SerialTransport(std::string port, unsigned baud)
    : port_(std::make_unique<Port>(std::move(port), baud)) {
  if (!SerialTransport::open())
    throw Error(
        Exit::no_device, port_->name, "cannot open the port (" + port_->failure.message() + ")",
        is_denied(port_->failure.value()) ? access_remedy(port_->name) : "check cable and name");
  set_connected(true);
}

SerialTransport::~SerialTransport() { SerialTransport::close(); }

bool SerialTransport::open() {
  boost::system::error_code error;
  // Asio opens with O_NOCTTY and O_NONBLOCK and sets the line raw.
  asio::serial_port& port = port_->port;
  port.open(port_->name, error);
  if (!error) port.set_option(asio::serial_port::baud_rate(port_->baud), error);
  if (!error) port.set_option(asio::serial_port::character_size(8), error);
  if (!error)
    port.set_option(asio::serial_port::flow_control(asio::serial_port::flow_control::none), error);
  if (error) {
    port_->failure = error;
    SerialTransport::close();
    return false;
  }
  const int fd = port.native_handle();
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
  keep_lines_on_close(fd);
  ask_low_latency(fd);
  // What came in before belongs to whoever had the port before.
  ::tcflush(fd, TCIFLUSH);
  return true;
}

void SerialTransport::close() {
  boost::system::error_code ignored;
  port_->port.close(ignored);
}

int SerialTransport::descriptor() { return port_->port.native_handle(); }

}  // namespace lamplock::link
