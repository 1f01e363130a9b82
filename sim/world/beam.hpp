// The continuous laser: when it shines, and with what power.
//
// In:  LASER GATE, LASER PWM behind its low-pass. It shines while the gate is open and there is
//      power, as docs/wiring.md has it (the two are ANDed).
// Out: every change of either, and what follows from them: power at any time, energy.
// Who: the bus. Gate and power come in order of time each, but not with each other (a duty is
//      measured afterwards), so that what is asked for is put together when it is asked for.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// From this time on, until the next one.
struct BeamChange {
  Picoseconds at = 0;
  bool gate = false;
  std::uint16_t power = 0;  ///< 65535 = full; what LASER PWM says, gate or not

  bool shines() const { return gate && power != 0; }
  /// Of the light.
  std::uint16_t light() const { return gate ? power : std::uint16_t{0}; }
  friend bool operator==(const BeamChange&, const BeamChange&) = default;
};

/// A continuous laser; must live as long as the bus is driven.
class Beam final : private PinListener, private PowerListener {
 public:
  explicit Beam(PinBus& bus);
  Beam(const Beam&) = delete;
  Beam& operator=(const Beam&) = delete;

  /// Everything that has happened, in order of time, from its first opening of the gate on. Made
  /// anew with each call.
  std::vector<BeamChange> changes() const;
  /// Just after whatever changed at `at`.
  BeamChange at(Picoseconds at) const;
  /// Full power for so many seconds, over [from, to].
  double energy(Picoseconds from, Picoseconds to) const;
  /// Light at any time in [from, to).
  bool shone(Picoseconds from, Picoseconds to) const;
  /// How often the gate has opened.
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
