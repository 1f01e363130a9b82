// The far end of the host's port: transfers the bytes of a simulated board.
//
// The board's driver polls it for bytes of the host and offers the board's bytes; no call waits,
// and a host may open and close the port at any time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace lamplock::sim {

/// One end of a byte stream.
class ByteEndpoint {
 public:
  virtual ~ByteEndpoint() = default;

  /// Reads what the host has sent; 0 if nothing, or if no host has the port open.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Writes without waiting; returns how many bytes were taken. Without a host, bytes taken may be
  /// lost, as on an unconnected cable.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// True if a host has the port open.
  virtual bool host_present() { return true; }

  /// The address that the host has to open.
  virtual std::string address() const = 0;
};

}  // namespace lamplock::sim
