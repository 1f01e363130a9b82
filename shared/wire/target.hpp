// A point of a job for the planner, and how points are joined.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::wire {

/// How the planner joins points; the values are those of the wire format.
enum class JoinMode : std::uint8_t { start_stop = 0, path = 1, free = 2 };

/// One target: its position on a beat, and the shots to fire there.
struct Target {
  StepPosition steps{};      ///< machine position, steps from machine zero
  std::uint16_t beats = 0;   ///< beats from the previous target; 0 = the planner chooses
  std::uint8_t shots = 1;    ///< flashes to fire here; 0 = pass without a shot
  std::uint8_t channel = 0;  ///< beam channel 0..3
  std::uint16_t energy = 0;  ///< energy or attenuator value, 0 = keep the current value
  bool dwell : 1 = false;    ///< rest at the previous target for exactly this many beats
  bool stop : 1 = false;     ///< be at rest here, in every mode
  bool rapid : 1 = false;    ///< of a program: the move to this target is a rapid
};

}  // namespace lamplock::wire
