// The shutters of the beam channels, with the time that they need to open and to close.
//
// In:  SHUTTER 1..4, high = open.
// Out: the channel of a shot, and whether the light path is clear.
// Who: the bus; laser and photosensors read it at the time of a shot.
#pragma once

#include <array>
#include <cstdint>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// Times of a shutter's motion.
struct ShutterConfig {
  Picoseconds open = 0;
  Picoseconds close = 0;
};

/// All shutters; must live as long as the bus is driven.
class Shutters final : public PinListener {
 public:
  Shutters(const ShutterConfig& config, PinBus& bus) : config_(config), bus_(bus) {
    since_.fill(-(config.open + config.close));  // closed for long
    for (int channel = 0; channel < beam_channels; ++channel)
      bus.listen(shutter_pin(channel), *this);
  }
  Shutters(const Shutters&) = delete;
  Shutters& operator=(const Shutters&) = delete;

  /// First channel whose shutter is commanded open; 0 if there is none.
  std::uint8_t channel() const {
    for (int c = 0; c < beam_channels; ++c)
      if (bus_.level(shutter_pin(c))) return static_cast<std::uint8_t>(c);
    return 0;
  }
  /// Exactly one shutter is fully open, and all others are fully closed.
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
