// A lamp that flashes as a test specifies: stops, jumps of the period.
#pragma once

#include <vector>

#include "tests/board/rig.hpp"

namespace lamplock::test {

/// Edges of LAMP SYNC from a lamp that follows a script.
class LampScript {
 public:
  /// The lamp flashes with this period for that long.
  LampScript& flash(Picoseconds period, Picoseconds time) {
    for (const Picoseconds end = now_ + time; now_ < end; now_ += period) edges_.push_back(now_);
    return *this;
  }
  LampScript& dark(Picoseconds time) {
    now_ += time;
    return *this;
  }
  /// Connects the script to a board whose own lamp does not flash.
  void connect(sim::VirtualBoard& board) const {
    constexpr Picoseconds width = 20 * ps_per_us;
    for (const Picoseconds edge : edges_) {
      board.world().schedule(sim::Pin::lamp_sync, true, edge);
      board.world().schedule(sim::Pin::lamp_sync, false, edge + width);
    }
  }

 private:
  Picoseconds now_ = ps_per_ms;
  std::vector<Picoseconds> edges_;
};

/// World whose lamp waits for a trigger that a slave never gives.
inline sim::WorldConfig dark_world() {
  sim::WorldConfig world;
  world.lamp.triggered = true;
  return world;
}

}  // namespace lamplock::test
