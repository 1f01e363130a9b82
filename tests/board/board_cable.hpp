// A good or bad cable to a board, with actions at given times.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string_view>

#include "tests/bad_cable.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::test {

/// Transport to a rig's board; simulated time passes while the host waits.
class BoardCable final : public BadCable {
 public:
  explicit BoardCable(Rig& rig, Faults faults = {}, std::uint64_t seed = 1)
      : BadCable(faults, seed), rig_(rig) {}

  /// Calls `action` when the board's clock shows `at`.
  void at(Picoseconds at, std::function<void()> action) { actions_.emplace(at, std::move(action)); }
  /// Sends bytes to the board past the cable.
  void type(std::string_view text) {
    rig_.board.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

 private:
  void machine_receive(std::span<const std::uint8_t> bytes) override { rig_.board.write(bytes); }
  void machine_reconnected() override { rig_.board.reconnect(); }
  void machine_run() override {
    const Picoseconds until = now().count() * ps_per_us;
    while (!actions_.empty() && actions_.begin()->first <= until) {
      rig_.board.run_until(actions_.begin()->first);
      const auto action = std::move(actions_.begin()->second);
      actions_.erase(actions_.begin());
      action();
    }
    rig_.board.run_until(until);
  }
  std::size_t machine_transmit(std::span<std::uint8_t> bytes) override {
    return rig_.board.read(bytes);
  }

  Rig& rig_;
  std::multimap<Picoseconds, std::function<void()>> actions_;
};

}  // namespace lamplock::test
