// A transport to a simulated board in this process, at the pace of the wall clock.
//
// In:  a board. Out: the board as a port of this computer would have it, for as long as the program
//      runs. Who: `serve --board virtual`.
//
// Each call runs the board up to now; a board that lags more than a tenth of a second, because the
// computer was busy or the simulation is slower than the wall clock, does not catch up.
#pragma once

#include <chrono>
#include <memory>

#include "host/link/simulated_transport.hpp"
#include "host/run/simulated_boards.hpp"

namespace lamplock::serve {

class PacedTransport final : public link::Transport {
 public:
  explicit PacedTransport(run::SimulatedBoard board)
      : made_(std::move(board)), inner_(*made_.board) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override;
  std::size_t read(std::span<std::uint8_t> bytes) override;
  void wait(std::chrono::microseconds time) override;
  std::chrono::microseconds now() const override { return inner_.now(); }
  bool reconnect() override { return inner_.reconnect(); }

 private:
  using Clock = std::chrono::steady_clock;
  void pass_time();

  run::SimulatedBoard made_;
  link::SimulatedTransport inner_;
  Clock::time_point passed_until_ = Clock::now();
};

}  // namespace lamplock::serve
