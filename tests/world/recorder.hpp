// Records changes of wires, for tests.
#pragma once

#include <cmath>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim::test {

struct Change {
  Pin pin;
  bool level;
  Picoseconds at;
  friend bool operator==(const Change&, const Change&) = default;
};

/// Records every change of the connected pins.
class Recorder final : public PinListener {
 public:
  Recorder(PinBus& bus, std::initializer_list<Pin> pins) {
    for (Pin pin : pins) bus.listen(pin, *this);
  }
  void pin_changed(Pin pin, bool level, Picoseconds at) override {
    changes.push_back({pin, level, at});
  }
  std::vector<Change> changes;
};

struct Pulse {
  Picoseconds rise, width;
};

/// Whole pulses among changes of one pin.
inline std::vector<Pulse> pulses(const std::vector<Change>& changes) {
  std::vector<Pulse> result;
  for (std::size_t i = 0; i + 1 < changes.size(); i += 2)
    result.push_back({changes[i].at, changes[i + 1].at - changes[i].at});
  return result;
}

}  // namespace lamplock::sim::test
