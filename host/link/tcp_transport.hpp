// A TCP connection: `lamplock sim --tcp`, or a serial server.
#pragma once

#include <memory>
#include <string>

#include "host/link/descriptor_transport.hpp"

namespace lamplock::link {

/// Connects to HOST:PORT, with TCP_NODELAY.
class TcpTransport : public DescriptorTransport {
 public:
  /// Throws Error(no_device) if the connection fails, Error(bad_input) if `address` is not
  /// HOST:PORT (IPv6 hosts in brackets).
  explicit TcpTransport(const std::string& address);
  ~TcpTransport() override;
  TcpTransport(const TcpTransport&) = delete;
  TcpTransport& operator=(const TcpTransport&) = delete;

 protected:
  bool open() override;
  void close() override;
  int descriptor() override;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace lamplock::link
