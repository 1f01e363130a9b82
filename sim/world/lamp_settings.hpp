// The lamp that matches a machine's settings.
//
// In:  the settings. Out: a lamp of that frequency, without a fault, which waits for its trigger
//      where the machine sends one. Who: simulated boards of the command line and of `check`.
#pragma once

#include "shared/settings_table.hpp"
#include "sim/world/lamp.hpp"

namespace lamplock::sim {

inline LampConfig lamp_of(const settings::Values& values) {
  using settings::Id;
  constexpr double milli = 1000;
  LampConfig lamp;
  lamp.frequency_hz = values.milli(Id::lamp_frequency) / milli;
  lamp.triggered = values.whole(Id::lamp_mode) == static_cast<int>(settings::LampMode::master);
  return lamp;
}

}  // namespace lamplock::sim
