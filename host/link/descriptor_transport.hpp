// Common part of serial ports and TCP connections: a non-blocking file descriptor and wall time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "host/link/transport.hpp"

namespace lamplock::link {

/// Transport over a descriptor that a derived class opens and closes.
class DescriptorTransport : public Transport {
 public:
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  std::size_t read(std::span<std::uint8_t> bytes) override;
  void wait(std::chrono::microseconds time) override;
  std::chrono::microseconds now() const override;
  bool connected() const override { return connected_; }
  bool reconnect() override;

 protected:
  /// Opens the connection; false if that fails for now.
  virtual bool open() = 0;
  virtual void close() = 0;
  /// The open descriptor; called only while connected.
  virtual int descriptor() = 0;

  void set_connected(bool connected) { connected_ = connected; }

 private:
  bool connected_ = false;
};

}  // namespace lamplock::link
