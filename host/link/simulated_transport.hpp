// A transport to a simulated board in the same process, in lock step with the host.
//
// wait() runs the board: simulated time passes only while the host waits, so that a job runs as
// fast as the computer allows and is reproducible.
#pragma once

#include <algorithm>
#include <cstdint>

#include "host/link/transport.hpp"
#include "sim/board.hpp"

namespace lamplock::link {

/// Session of jobs on simulated boards: a random one would change the length of frames by a byte,
/// and the start of a job by a beat.
inline constexpr std::uint32_t simulated_session = 1;

/// The board must outlive the transport.
class SimulatedTransport final : public Transport {
 public:
  explicit SimulatedTransport(sim::Board& board) : board_(board) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override { return board_.write(bytes); }
  std::size_t read(std::span<std::uint8_t> bytes) override { return board_.read(bytes); }
  void wait(std::chrono::microseconds time) override {
    const sim::Picoseconds until = board_.now() + time.count() * sim::ps_per_us;
    while (board_.now() < until && !board_.has_output())
      board_.run_until(std::min(until, board_.now() + slice));
  }
  std::chrono::microseconds now() const override {
    return std::chrono::microseconds(board_.now() / sim::ps_per_us);
  }
  bool reconnect() override {
    board_.reconnect();
    return true;
  }

 private:
  /// The board is asked this often whether it has sent something: one frame of USB.
  static constexpr sim::Picoseconds slice = sim::ps_per_ms;
  sim::Board& board_;
};

}  // namespace lamplock::link
