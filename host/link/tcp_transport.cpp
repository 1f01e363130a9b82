#include "host/link/tcp_transport.hpp"

#include <fcntl.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <utility>

#include "host/error.hpp"
#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::link {
namespace asio = boost::asio;
using asio::ip::tcp;

struct TcpTransport::Connection {
  explicit Connection(sim::TcpAddress address_in) : address(std::move(address_in)) {}
  sim::TcpAddress address;
  asio::io_context context;
  tcp::socket socket{context};
  std::string failure;
};

namespace {

/// The system's own time-out for a host that does not answer is minutes.
constexpr std::chrono::seconds connect_timeout{5};

/// Connects within the time-out.
boost::system::error_code connect(asio::io_context& context, tcp::socket& socket,
                                  const sim::TcpAddress& address) {
  boost::system::error_code error;
  tcp::resolver resolver(context);
  const auto endpoints = resolver.resolve(address.host, address.port, error);
  if (error) return error;
  error = asio::error::timed_out;
  asio::async_connect(
      socket, endpoints,
      [&error](const boost::system::error_code& result, const tcp::endpoint&) { error = result; });
  context.restart();
  context.run_for(connect_timeout);
  if (!context.stopped()) {
    socket.close();
    context.run();
    error = asio::error::timed_out;
  }
  return error;
}

}  // namespace

TcpTransport::TcpTransport(const std::string& address) {
  const auto parsed = sim::parse_tcp_address(address);
  if (!parsed) throw Error(Exit::bad_input, address, "is not an address", "write HOST:PORT");
  connection_ = std::make_unique<Connection>(*parsed);
  if (!TcpTransport::open())
    throw Error(Exit::no_device, address, "no connection (" + connection_->failure + ")",
                "check the address, and that the machine or `lamplock sim` is running there");
  set_connected(true);
}

TcpTransport::~TcpTransport() { TcpTransport::close(); }

bool TcpTransport::open() {
  Connection& c = *connection_;
  boost::system::error_code error = connect(c.context, c.socket, c.address);
  if (!error) c.socket.set_option(tcp::no_delay(true), error);
  if (!error) c.socket.non_blocking(true, error);
  if (!error) c.socket.native_non_blocking(true, error);
  if (!error) return true;
  c.failure = error.message();
  close();
  return false;
}

void TcpTransport::close() {
  boost::system::error_code ignored;
  connection_->socket.close(ignored);
}

int TcpTransport::descriptor() { return connection_->socket.native_handle(); }

}  // namespace lamplock::link
