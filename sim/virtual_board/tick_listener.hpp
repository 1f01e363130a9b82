// Receives the ticks and the motion of the virtual board, exactly: ticks, not pins.
//
// In:  every run of ticks as it is put out, the beginning of every beat.
// Who: motion_trace.hpp, tests. Costs nothing without a listener.
#pragma once

#include <cstdint>

#include "firmware/stepper/tick_block.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim {

/// Ticks `from` to `to` of a block, the last one not included.
struct PlayedTicks {
  const stepper::TickBlock& block;
  std::uint64_t from, to;
  Picoseconds start, end;  ///< when the first one begins and the last one ends
};

/// Calls come in order of ticks; a beat is reported before the ticks in it.
class TickListener {
 public:
  virtual ~TickListener() = default;
  virtual void ticks_played(const PlayedTicks& ticks) = 0;
  /// A beat of the lattice begins at this tick and time, independent of the lamp.
  virtual void beat_begins(std::uint64_t tick, Picoseconds at) = 0;
};

}  // namespace lamplock::sim
