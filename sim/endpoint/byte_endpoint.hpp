// Where a simulated board's bytes go in and out: the far end of the host's port.
//
// The board's driver asks now and then whether the host has sent something and offers what the
// board sends; nothing here ever waits, and a host that comes and goes is nothing unusual.
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

  /// Reads what the host has sent; 0 if nothing, or nobody is there.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Writes what goes now; returns how many bytes were taken. Bytes taken while nobody is there may
  /// be lost, as on a cable that ends nowhere.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// A host has the port open.
  virtual bool host_present() { return true; }

  /// What the host has to open.
  virtual std::string address() const = 0;
};

}  // namespace lamplock::sim
