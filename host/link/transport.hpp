// A way to and from the firmware: serial port, TCP, or a board in the same process.
//
// In/out: bytes, never waiting. The sender owns the pace: it writes, reads, and waits for as long
// as the transport lets it. Time is the transport's: wall time on real ports, simulated time on a
// simulated board, so that time-outs mean the same on both.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lamplock::link {

/// One connection.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Writes as much as goes now; returns how many bytes were taken. 0 if the connection is cut.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// Reads what is there; returns how many bytes.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Waits until there is something to read, or `time` has passed. A simulated board runs for so
  /// long, and may stop earlier when it has sent something.
  virtual void wait(std::chrono::microseconds time) = 0;

  /// Time since some fixed moment; never goes back.
  virtual std::chrono::microseconds now() const = 0;

  /// False once the connection is known to be cut.
  virtual bool connected() const { return true; }

  /// Drops what is left of the connection and tries once to make a new one; true if there is one.
  virtual bool reconnect() = 0;
};

}  // namespace lamplock::link
