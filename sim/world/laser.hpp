// The pulsed laser: records every release of its Q-switch and judges its timing.
//
// In:  Q-SWITCH; shutters and attenuator, flashes from the lamp and positions from the drives, all
//      at the time of the shot. The laser emits at the start of the pulse.
// Out: one Shot per pulse, in order, and counts of pulses that its signals do not allow: Q-SWITCH
//      has to start at most 20 us after LAMP SYNC and to be wider than 100 us ("Mechatroniczne
//      pozycjonowanie wiazki lasera impulsowego...", table of controller signals).
// Who: the bus; World calls settle() as time passes, because a board may deliver the steps of a
//      slice of time after the shot that lies in it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/world/drives.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/pins.hpp"
#include "sim/world/shots.hpp"
#include "sim/world/shutters.hpp"

namespace lamplock::sim {

inline constexpr Picoseconds latest_q_switch = 20 * ps_per_us;
inline constexpr Picoseconds narrowest_q_switch = 100 * ps_per_us;

/// The laser; must live as long as the bus is driven.
class Laser final : public PinListener {
 public:
  Laser(PinBus& bus, const Lamp& lamp, const Drives& drives, const Shutters& shutters);
  Laser(const Laser&) = delete;
  Laser& operator=(const Laser&) = delete;

  const Shots& shots() const { return shots_; }

  /// Pulses not wider than 100 us.
  std::uint64_t narrow_pulses() const { return narrow_; }
  /// Pulses that start more than 20 us after the latest flash.
  std::uint64_t late_pulses() const { return late_; }
  /// Pulses before the first flash.
  std::uint64_t unlit_pulses() const { return unlit_; }
  /// Pulses while no shutter was fully open, or one of another channel not fully closed.
  std::uint64_t stray_pulses() const { return stray_; }

  /// All changes up to `complete_to` have been delivered: positions of shots before it are final.
  void settle(Picoseconds complete_to) {
    if (unsettled_ < shots_.size()) settle_shots(complete_to);
  }

  void pin_changed(Pin pin, bool level, Picoseconds at) override;

 private:
  void settle_shots(Picoseconds complete_to);

  const Lamp& lamp_;
  const Drives& drives_;
  const Shutters& shutters_;
  const PinBus& bus_;
  Shots shots_;
  std::size_t unsettled_ = 0;  ///< first shot whose position may still change
  std::uint64_t narrow_ = 0;
  std::uint64_t late_ = 0;
  std::uint64_t unlit_ = 0;
  std::uint64_t stray_ = 0;
};

}  // namespace lamplock::sim
