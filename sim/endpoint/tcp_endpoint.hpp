// A TCP server: one host at a time.
#pragma once

#include <memory>
#include <string>

#include "sim/endpoint/byte_endpoint.hpp"

namespace lamplock::sim {

/// Listens on HOST:PORT. A host that connects replaces an earlier one, whose connection may have
/// died without notice.
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
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace lamplock::sim
