// The photosensors of the beam channels: each detects whether a shot has made its defect.
//
// In:  Q-SWITCH; the channel that the light goes through.
// Out: PHOTOSENSOR 1..4: a pulse (wider than 10 us, "Mechatroniczne pozycjonowanie wiazki lasera
//      impulsowego...", table of controller signals) some time after a shot that made its defect;
//      faults: a defect that is not made, a sensor that detects nothing, a line that is stuck high.
// Who: World calls next_event() and advance(); a comparison when nothing is due.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim/world/pins.hpp"
#include "sim/world/random.hpp"
#include "sim/world/shutters.hpp"

namespace lamplock::sim {

struct PhotosensorConfig {
  Picoseconds answer = 20 * ps_per_us;  ///< after the start of the Q-switch pulse
  Picoseconds width = 15 * ps_per_us;   ///< of the answer
  double failure = 0;                   ///< probability that a shot makes no defect
  bool blind = false;                   ///< detects nothing
  bool stuck_high = false;
  std::uint64_t seed = 1;
};

/// All photosensors; must live as long as the bus is driven.
class Photosensors final : public PinListener {
 public:
  Photosensors(const PhotosensorConfig& config, PinBus& bus, const Shutters& shutters)
      : config_(config), bus_(bus), shutters_(shutters), random_(config.seed) {
    bus.listen(Pin::q_switch, *this);
    for (int channel = 0; channel < beam_channels && config.stuck_high; ++channel)
      bus.set(photosensor_pin(channel), true, 0);
  }
  Photosensors(const Photosensors&) = delete;
  Photosensors& operator=(const Photosensors&) = delete;

  /// `never` if nothing is due.
  Picoseconds next_event() const { return std::min(rise_, fall_); }
  void advance(Picoseconds to) {
    if (rise_ <= to) {
      bus_.set(pin_, true, rise_);
      rise_ = never;
    }
    if (fall_ <= to) {
      bus_.set(pin_, false, fall_);
      fall_ = never;
    }
  }

  /// For each shot, in order: whether it has made its defect.
  const std::vector<bool>& made() const { return made_; }

  void pin_changed(Pin /*pin*/, bool level, Picoseconds at) override {
    if (!level) return;
    // Always drawn: 53 bits, so that the shots after a fault are the same as without it.
    const bool made = random_.uniform() >= config_.failure;
    made_.push_back(made);
    if (!made || config_.blind || config_.stuck_high || next_event() != never) return;
    pin_ = photosensor_pin(shutters_.channel());
    rise_ = at + config_.answer;
    fall_ = rise_ + config_.width;
  }

 private:
  PhotosensorConfig config_;
  PinBus& bus_;
  const Shutters& shutters_;
  Random random_;
  Pin pin_ = Pin::photosensor_1;
  Picoseconds rise_ = never, fall_ = never;
  std::vector<bool> made_;
};

}  // namespace lamplock::sim
