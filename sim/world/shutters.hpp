// The shutters of the beam channels: they take their time to open and to close.
//
// In:  SHUTTER 1..4, high = open.
// Out: which channel a shot goes through, and whether the way of the light is clear.
// Who: the bus; laser and photosensors ask at the time of a shot.
#pragma once

#include <array>
#include <cstdint>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// How long a shutter moves.
struct ShutterConfig {
  Picoseconds open = 0;
  Picoseconds close = 0;
};

/// All of them; must live as long as the bus is driven.
class Shutters final : public PinListener {
 public:
  Shutters(const ShutterConfig& config, PinBus& bus) : config_(config), bus_(bus) {
    since_.fill(-(config.open + config.close));  // closed for long
    for (int channel = 0; channel < beam_channels; ++channel)
      bus.listen(shutter_pin(channel), *this);
  }
  Shutters(const Shutters&) = delete;
  Shutters& operator=(const Shutters&) = delete;

  /// First channel that is told to be open; 0 if there is none.
  std::uint8_t channel() const {
    for (int c = 0; c < beam_channels; ++c)
      if (bus_.level(shutter_pin(c))) return static_cast<std::uint8_t>(c);
    return 0;
  }
  /// Exactly one shutter is open, wholly, and all others are closed, wholly.
  bool clear(Picoseconds at) const {
    int open = 0;
    for (int c = 0; c < beam_channels; ++c) {
      const bool level = bus_.level(shutter_pin(c));
      const Picoseconds time = at - since_[static_cast<std::size_t>(c)];
      if (time < (level ? config_.open : config_.close)) return false;
      open += level ? 1 : 0;
    }
    return open == 1;
  }

  void pin_changed(Pin pin, bool /*level*/, Picoseconds at) override {
    since_[static_cast<std::size_t>(pin) - static_cast<std::size_t>(Pin::shutter_1)] = at;
  }

 private:
  ShutterConfig config_;
  const PinBus& bus_;
  std::array<Picoseconds, beam_channels> since_{};
};

}  // namespace lamplock::sim
