// The continuous laser: when it shines, and with what power.
//
// In:  LASER GATE, LASER PWM after its low-pass. The laser shines while the gate is open and there
//      is power, as in docs/wiring.md (the two are ANDed).
// Out: every change of either; power at any time, and energy.
// Who: the bus. Gate and power come in order of time each, but not with each other (a duty is
//      measured afterwards), so they are combined only when they are read.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// State from this time on, until the next change.
struct BeamChange {
  Picoseconds at = 0;
  bool gate = false;
  std::uint16_t power = 0;  ///< 65535 = full; of LASER PWM, even with the gate closed

  bool shines() const { return gate && power != 0; }
  /// Power of the light.
  std::uint16_t light() const { return gate ? power : std::uint16_t{0}; }
  friend bool operator==(const BeamChange&, const BeamChange&) = default;
};

/// A continuous laser; must live as long as the bus is driven.
class Beam final : private PinListener, private PowerListener {
 public:
  explicit Beam(PinBus& bus);
  Beam(const Beam&) = delete;
  Beam& operator=(const Beam&) = delete;

  /// All changes in order of time, from the first opening of the gate on. Computed in each call.
  std::vector<BeamChange> changes() const;
  /// State after all changes at `at`.
  BeamChange at(Picoseconds at) const;
  /// Energy over [from, to], in seconds at full power.
  double energy(Picoseconds from, Picoseconds to) const;
  /// Light at any time in [from, to).
  bool shone(Picoseconds from, Picoseconds to) const;
  /// Number of times that the gate has opened.
  std::size_t openings() const { return openings_; }

 private:
  struct GateEdge {
    Picoseconds at;
    bool level;
  };
  struct PowerChange {
    Picoseconds at;
    std::uint16_t power;
  };
  void pin_changed(Pin pin, bool level, Picoseconds at) override;
  void power_changed(std::uint16_t power, Picoseconds at) override;
  bool gate_at(Picoseconds at) const;
  std::uint16_t power_at(Picoseconds at) const;

  std::vector<GateEdge> gate_;
  std::vector<PowerChange> power_;
  std::size_t openings_ = 0;
};

}  // namespace lamplock::sim
