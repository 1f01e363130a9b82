#include "host/link/serial_transport.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <cerrno>
#include <utility>

#include "host/access.hpp"
#include "host/error.hpp"
#include "host/link/port_lock.hpp"
#include "host/similar_files.hpp"
#include "host/suggestion.hpp"
#include "host/usb/known_devices.hpp"
#include "host/usb/sysfs.hpp"

namespace lamplock::link {
namespace asio = boost::asio;

struct SerialTransport::Port {
  Port(std::string name_in, unsigned baud_in) : name(std::move(name_in)), baud(baud_in) {}
  std::string name;
  unsigned baud;
  asio::io_context context;
  asio::serial_port port{context};
  PortLock lock;
  boost::system::error_code failure;
};

namespace {

/// Whether closing the port drops DTR. Some boards reset then; a lamplock board detects by it that
/// its host has ended, even if it was killed.
void set_hang_up(int descriptor, bool hang_up) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return;
  constexpr auto flag = static_cast<tcflag_t>(HUPCL);
  settings.c_cflag = hang_up ? settings.c_cflag | flag : settings.c_cflag & ~flag;
  settings.c_cflag |= CLOCAL;
  ::tcsetattr(descriptor, TCSANOW, &settings);
}

/// Asks the driver not to collect bytes for milliseconds; USB and pseudo-terminals neither support
/// nor need this.
void ask_low_latency(int descriptor) {
  serial_struct driver{};
  if (::ioctl(descriptor, TIOCGSERIAL, &driver) != 0) return;
  driver.flags = static_cast<int>(static_cast<unsigned>(driver.flags) | ASYNC_LOW_LATENCY);
  ::ioctl(descriptor, TIOCSSERIAL, &driver);
}

}  // namespace

Error missing_port(const std::string& port) {
  const std::string question = question_of(similar_paths(port, PathKind::port));
  return {Exit::no_device, port, "there is no such port",
          question.empty() ? "plug in the board, then lamplock devices shows its port" : question};
}

SerialTransport::SerialTransport(std::string port, unsigned baud)
    : port_(std::make_unique<Port>(std::move(port), baud)) {
  if (SerialTransport::open()) {
    set_connected(true);
    return;
  }
  if (!port_->lock.user().empty())
    throw Error(Exit::no_device, port_->name,
                "another program uses the port (" + port_->lock.user() + ")",
                "end that program first");
  if (port_->failure.value() == ENOENT) throw missing_port(port_->name);
  throw Error(
      Exit::no_device, port_->name, "cannot open the port (" + port_->failure.message() + ")",
      is_denied(port_->failure.value()) ? access_remedy(port_->name) : "check cable and name");
}

SerialTransport::~SerialTransport() { SerialTransport::close(); }

bool SerialTransport::open() {
  boost::system::error_code error;
  if (!port_->lock.take(port_->name)) {
    port_->failure = {port_->lock.failure(), boost::system::system_category()};
    return false;
  }
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
  set_hang_up(fd, usb::manufacturer_of_port(port_->name) == usb::board_manufacturer);
  ask_low_latency(fd);
  port_->lock.refuse_others();
  // Bytes received earlier belong to an earlier program.
  ::tcflush(fd, TCIFLUSH);
  return true;
}

void SerialTransport::close() {
  boost::system::error_code ignored;
  port_->port.close(ignored);
  port_->lock.release();
}

int SerialTransport::descriptor() { return port_->port.native_handle(); }

}  // namespace lamplock::link
