#include "host/run/endpoints.hpp"

#include <stdexcept>
#include <system_error>

#include "host/error.hpp"
#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::run {
namespace {

[[noreturn]] void refuse_port(const std::string& option, const std::error_code& error,
                              const std::string& remedy) {
  throw Error(Exit::no_device, option, "cannot be opened (" + error.message() + ")", remedy);
}

/// What to do about an address at which this computer cannot listen.
std::string remedy_for_address(const std::error_code& error) {
  if (error == std::errc::address_in_use)
    return "another program listens there: give another port, or 0 for any free port";
  if (error == std::errc::address_not_available)
    return "give an address of this computer, such as 127.0.0.1:4000";
  if (error == std::errc::permission_denied) return "give a port from 1024 on";
  return "give another address or port, such as 127.0.0.1:4000";
}

}  // namespace

std::unique_ptr<sim::PtyEndpoint> open_pty(const std::string& option, const std::string& link) {
  try {
    return std::make_unique<sim::PtyEndpoint>(link);
  } catch (const std::system_error& error) {
    refuse_port(option, error.code(),
                error.code() == std::errc::file_exists
                    ? "give a name that no file has: a link is made there"
                    : "give another name, in a folder that exists");
  }
}

std::unique_ptr<sim::TcpEndpoint> open_tcp(const std::string& option, const std::string& address) {
  if (!sim::parse_tcp_address(address))
    throw Error(Exit::bad_input, option, "is not HOST:PORT",
                "give the port too, from 0 (any free one) to 65535, such as 127.0.0.1:4000");
  try {
    return std::make_unique<sim::TcpEndpoint>(address);
  } catch (const std::invalid_argument&) {
    throw Error(Exit::bad_input, option,
                "this computer cannot resolve the name of the host or the port",
                "check the name; 127.0.0.1:4000 is a port for this computer alone");
  } catch (const std::system_error& error) {
    refuse_port(option, error.code(), remedy_for_address(error.code()));
  }
}

}  // namespace lamplock::run
