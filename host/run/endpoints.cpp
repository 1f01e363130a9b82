#include "host/run/endpoints.hpp"

#include <stdexcept>
#include <system_error>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

template <typename Endpoint>
std::unique_ptr<Endpoint> open(const std::string& option, const std::string& where) {
  try {
    return std::make_unique<Endpoint>(where);
  } catch (const std::invalid_argument& error) {
    throw Error(Exit::bad_input, option, error.what(), "write HOST:PORT");
  } catch (const std::system_error& error) {
    throw Error(Exit::no_device, option, "cannot be opened (" + error.code().message() + ")",
                "choose another name or port");
  }
}

}  // namespace

std::unique_ptr<sim::PtyEndpoint> open_pty(const std::string& option, const std::string& link) {
  return open<sim::PtyEndpoint>(option, link);
}

std::unique_ptr<sim::TcpEndpoint> open_tcp(const std::string& option, const std::string& address) {
  return open<sim::TcpEndpoint>(option, address);
}

}  // namespace lamplock::run
