// A TCP server: one host at a time.
#pragma once

#include <memory>
#include <string>

#include "sim/endpoint/byte_endpoint.hpp"

namespace lamplock::sim {

/// Listens on HOST:PORT. While a host is connected, the connection of another one is closed at
/// once: it must not end a job that runs. A connection that has died without notice ends after half
/// a minute.
class TcpEndpoint : public ByteEndpoint {
 public:
  /// With port 0 the system chooses one; address() returns it. Throws std::system_error if the
  /// address cannot be used, std::invalid_argument if it is not HOST:PORT.
  explicit TcpEndpoint(const std::string& address);
  ~TcpEndpoint() override;
  TcpEndpoint(const TcpEndpoint&) = delete;
  TcpEndpoint& operator=(const TcpEndpoint&) = delete;

  std::size_t read(std::span<std::uint8_t> bytes) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  bool host_present() override;
  std::string address() const override;

 private:
  void accept();
  bool is_connected() const;
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace lamplock::sim
