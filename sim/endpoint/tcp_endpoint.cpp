#include "sim/endpoint/tcp_endpoint.hpp"

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <stdexcept>
#include <system_error>

#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::sim {
namespace asio = boost::asio;
using asio::ip::tcp;

struct TcpEndpoint::Server {
  asio::io_context context{};
  tcp::acceptor acceptor{context};
  tcp::socket client{context};
};

namespace {

bool try_later(const boost::system::error_code& error) {
  return error == asio::error::would_block || error == asio::error::try_again ||
         error == asio::error::interrupted;
}

[[noreturn]] void fail(const boost::system::error_code& error, const std::string& address) {
  throw std::system_error(error.value(), std::generic_category(), address);
}

/// A computer that was switched off or unplugged sends no end of its connection.
void find_dead_connections(tcp::socket& socket) {
  constexpr int silence_s = 15, interval_s = 5, end_ms = 30'000;
  const auto set = [&socket](int level, int name, int value) {
    ::setsockopt(socket.native_handle(), level, name, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, silence_s);
  set(IPPROTO_TCP, TCP_KEEPINTVL, interval_s);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, end_ms);
}

}  // namespace

TcpEndpoint::TcpEndpoint(const std::string& address) : server_(std::make_unique<Server>()) {
  const auto parsed = parse_tcp_address(address);
  if (!parsed) throw std::invalid_argument(address + " is not HOST:PORT");
  boost::system::error_code error;
  tcp::resolver resolver(server_->context);
  const auto endpoints =
      resolver.resolve(parsed->host, parsed->port, tcp::resolver::passive, error);
  if (error) throw std::invalid_argument(address + ": " + error.message());
  tcp::acceptor& acceptor = server_->acceptor;
  const tcp::endpoint endpoint = *endpoints.begin();
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) acceptor.non_blocking(true, error);
  if (error) fail(error, address);
}

TcpEndpoint::~TcpEndpoint() = default;

void TcpEndpoint::accept() {
  boost::system::error_code error;
  tcp::socket next(server_->context);
  server_->acceptor.accept(next, error);
  if (error || is_connected()) return;
  next.set_option(tcp::no_delay(true), error);
  find_dead_connections(next);
  next.non_blocking(true, error);
  server_->client = std::move(next);
}

std::size_t TcpEndpoint::read(std::span<std::uint8_t> bytes) {
  accept();
  if (!server_->client.is_open() || bytes.empty()) return 0;
  boost::system::error_code error;
  const std::size_t count =
      server_->client.read_some(asio::buffer(bytes.data(), bytes.size()), error);
  if (error && !try_later(error)) server_->client.close(error);
  return count;
}

std::size_t TcpEndpoint::write(std::span<const std::uint8_t> bytes) {
  accept();
  if (!server_->client.is_open() || bytes.empty()) return bytes.size();
  boost::system::error_code error;
  const std::size_t count =
      server_->client.write_some(asio::buffer(bytes.data(), bytes.size()), error);
  if (!error) return count;
  if (try_later(error)) return 0;
  server_->client.close(error);
  return bytes.size();
}

bool TcpEndpoint::host_present() {
  accept();
  return is_connected();
}

bool TcpEndpoint::is_connected() const {
  if (!server_->client.is_open()) return false;
  // The end of the stream, even where bytes before it have not been read.
  pollfd state{server_->client.native_handle(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) <= 0 || (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
}

std::string TcpEndpoint::address() const {
  boost::system::error_code error;
  const tcp::endpoint local = server_->acceptor.local_endpoint(error);
  const std::string host = local.address().to_string();
  return (local.address().is_v6() ? "[" + host + "]" : host) + ":" + std::to_string(local.port());
}

}  // namespace lamplock::sim
