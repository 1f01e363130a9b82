// Drives at rest: which are released, and when they may be stepped again.
//
// In:  settings ($1, $37), the time, whether the machine has nothing to move.
// Out: which enable wires are on; whether all drives hold.
// Who: the controller, once in every round of the main loop, masked; some 20 cycles while nothing
//      changes.
//
// Axes on one wire are released only if all of them may be. Two wires at most: one for all axes, or
// one for Z and A and one for the rest.
#pragma once

#include <array>
#include <cstdint>

#include "shared/drive_times.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// Drives hold at least this long after the last motion was filled, whatever $1 says: its ticks are
/// not out yet, and drives lag.
inline constexpr std::uint32_t min_hold_ms = 25;

class IdleRelease {
 public:
  static constexpr std::size_t wires = 2;
  /// Value of $1 that means never.
  static constexpr std::int32_t never_ms = 255;

  /// A bit for each axis whose drive is on the second wire.
  explicit IdleRelease(std::uint8_t second_wire) : second_wire_(second_wire) {}

  /// `rests`: the machine is at rest with nothing to move it. `off`: no drive may be on (e-stop,
  /// sleep).
  void update(const settings::Values& values, std::uint64_t clock, bool rests, bool off) {
    if (were_off_) ready_ = clock + wake_clocks;
    were_off_ = false;
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

  /// The board had disabled the drives itself, to set them up: they wake from the next round on.
  void were_off() { were_off_ = true; }

  bool on(std::size_t wire) const { return on_[wire]; }
  bool all_on() const { return on_[0] && on_[1]; }
  /// Steps may be sent.
  bool ready(std::uint64_t clock) const { return all_on() && !were_off_ && clock >= ready_; }

 private:
  using Wires = std::array<bool, wires>;
  static constexpr std::uint64_t wake_clocks = std::uint64_t{drive_wake_ms} * 1000 * clocks_per_us;

  static std::uint64_t hold_clocks(const settings::Values& values) {
    const auto ms = static_cast<std::uint32_t>(values.whole(settings::Id::idle_delay));
    return std::uint64_t{ms < min_hold_ms ? min_hold_ms : ms} * 1000 * clocks_per_us;
  }
  /// Wires with at least one axis that must not be released.
  Wires held(const settings::Values& values) const {
    const std::uint32_t axes = (1u << values.whole(settings::Id::axes)) - 1;
    const auto released = static_cast<std::uint32_t>(values.whole(settings::Id::idle_release));
    const std::uint32_t kept = axes & ~released;
    return {(kept & ~unsigned{second_wire_}) != 0, (kept & second_wire_) != 0};
  }
  void set(const Wires& wanted, std::uint64_t clock) {
    for (std::size_t i = 0; i < wires; ++i)
      if (wanted[i] && !on_[i]) ready_ = clock + wake_clocks;
    on_ = wanted;
  }

  const std::uint8_t second_wire_;
  Wires on_{true, true};
  bool rests_ = false, were_off_ = false;
  std::uint64_t since_ = 0, ready_ = 0;  ///< clocks
};

}  // namespace lamplock::machine
