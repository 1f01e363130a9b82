// Drives at rest: which are released, and when they may be stepped again.
//
// In:  settings ($1, $37), the time, whether the machine has nothing to move.
// Out: which enable wires are on; whether all drives hold by now.
// Who: the controller, once in every round of the main loop, masked; some 20 cycles while nothing
//      changes.
//
// Axes on one wire are released only if all of them may be. Two wires at most: that of all axes, or
// of all but Z and A, which then have one of their own.
#pragma once

#include <array>
#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// A drive that was released holds, and takes steps, this long after its enable: some stepper
/// drives want 200 ms and lose steps before (grbl-Mega-5X issue 364: a DM556T), others 5 us (g2
/// issue 290: an AM882). grbl waits for none (grbl issue 522: a DM542T loses steps).
inline constexpr std::uint32_t drive_wake_ms = 200;
/// Drives hold at least so long after the last motion was filled, whatever $1 says: its ticks are
/// not out yet, and drives follow late.
inline constexpr std::uint32_t least_hold_ms = 25;

class DriveRest {
 public:
  static constexpr std::size_t wires = 2;
  /// $1 that means never.
  static constexpr std::int32_t never_ms = 255;

  /// A bit for each axis whose drive is on the second wire.
  explicit DriveRest(std::uint8_t second_wire) : second_wire_(second_wire) {}

  /// `rests`: the machine stands, and nothing is known that would move it. `off`: no drive may be
  /// on (e-stop, sleep).
  void update(const settings::Values& values, std::uint64_t clock, bool rests, bool off) {
    if (off) {
      set({}, clock);
      return;
    }
    if (!rests || values.milli(settings::Id::idle_delay) == never_ms * 1000) {
      rests_ = false;
      set({true, true}, clock);
      return;
    }
    if (!rests_) since_ = clock;
    rests_ = true;
    if (clock - since_ >= hold_clocks(values)) set(held(values), clock);
  }

  bool on(std::size_t wire) const { return on_[wire]; }
  bool all_on() const { return on_[0] && on_[1]; }
  /// Steps may come.
  bool ready(std::uint64_t clock) const { return all_on() && clock >= ready_; }

 private:
  using Wires = std::array<bool, wires>;

  static std::uint64_t hold_clocks(const settings::Values& values) {
    const auto ms = static_cast<std::uint32_t>(values.whole(settings::Id::idle_delay));
    return std::uint64_t{ms < least_hold_ms ? least_hold_ms : ms} * 1000 * clocks_per_us;
  }
  /// Wires of which some axis is not to be released.
  Wires held(const settings::Values& values) const {
    const std::uint32_t axes = (1u << values.whole(settings::Id::axes)) - 1;
    const auto released = static_cast<std::uint32_t>(values.whole(settings::Id::idle_release));
    const std::uint32_t kept = axes & ~released;
    return {(kept & ~unsigned{second_wire_}) != 0, (kept & second_wire_) != 0};
  }
  void set(const Wires& wanted, std::uint64_t clock) {
    for (std::size_t i = 0; i < wires; ++i)
      if (wanted[i] && !on_[i])
        ready_ = clock + std::uint64_t{drive_wake_ms} * 1000 * clocks_per_us;
    on_ = wanted;
  }

  const std::uint8_t second_wire_;
  Wires on_{true, true};
  bool rests_ = false;
  std::uint64_t since_ = 0, ready_ = 0;  ///< clocks
};

}  // namespace lamplock::machine
