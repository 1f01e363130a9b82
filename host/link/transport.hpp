// A connection to the firmware: serial port, TCP, or a board in the same process.
//
// In/out: bytes, without blocking. The caller sets the pace: it writes, reads, and calls wait().
// Time is the transport's: wall time on real ports, simulated time on a simulated board, so that
// time-outs are the same on both.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace lamplock::link {

/// One connection.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Writes as many bytes as possible now; returns their number, 0 if the connection is cut.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// Reads the received bytes; returns their number.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Waits until bytes were received, or `time` has passed. A simulated board runs for this time,
  /// or stops earlier when it has sent bytes.
  virtual void wait(std::chrono::microseconds time) = 0;

  /// Time since a fixed moment; monotonic.
  virtual std::chrono::microseconds now() const = 0;

  /// False once the connection is known to be cut.
  virtual bool connected() const { return true; }

  /// Closes the connection and tries once to make a new one; true if that succeeds.
  virtual bool reconnect() = 0;

  /// How users name the board after --board; empty for a simulated board.
  const std::string& board() const { return board_; }
  void set_board(std::string name) { board_ = std::move(name); }

 private:
  std::string board_;
};

}  // namespace lamplock::link
