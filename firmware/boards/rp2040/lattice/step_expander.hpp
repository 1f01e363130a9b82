// From runs of ticks to words for the state machines.
//
// In:  runs of each axis, of the lattice bits and of the laser's power, as the core's fill_axes()
//      tells them.
// Out: words in the LatticeRings, a fixed number of ticks each; counts of LASER PWM; how far the
//      rings are filled.
// Who: the fill interrupt (priority 3); begin() and steps_at() with that interrupt masked.
// Budget: per axis and run some 200 cycles and at most 7 a tick, 2 where steps are rare; about a
//      quarter of a cycle a tick where it stands; for power 40 a call and half a cycle a tick.
//
// Power has one value a cell: that of the last tick up to its middle that shines, or else of the
// first one behind.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/stepper/tick_block.hpp"

namespace lamplock::rp2040 {

/// Levels of the pins of BITS, one nibble a tick.
constexpr std::uint32_t lattice_nibble(std::uint8_t bits) {
  constexpr std::uint32_t trigger_pin = 1, gate_pin = 2, arm_pin = 4;
  return ((bits & stepper::trigger_bit) != 0 ? trigger_pin : 0) |
         ((bits & stepper::gate_bit) != 0 ? gate_pin : 0) |
         ((bits & stepper::arm_bit) != 0 ? arm_pin : 0);
}

/// Fills the rings.
class StepExpander {
 public:
  StepExpander(LatticeRings& rings, PowerRing& power) : rings_(rings), power_(power) {}

  /// Starts anew: the first word begins with tick `first`; up to the tick `filled`, from where on
  /// runs are told, everything stands.
  void begin(std::uint64_t first, std::uint64_t filled, const StepPosition& steps);

  // What fill_axes() tells; the caller has made sure that there is room.
  void put_still(int axis, std::uint32_t ticks);
  void put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks);
  void put_bits(std::uint8_t bits, std::uint32_t ticks);
  void put_power(std::uint16_t power, std::uint32_t ticks);
  void set_step(int axis, std::int32_t step) { steps_[index(axis)] = step; }
  /// So many ticks have been told of every axis and of the bits.
  void end_runs(std::uint32_t ticks) { end_ += ticks; }

  /// First tick that has not been told.
  std::uint64_t end_tick() const { return end_; }
  /// Ticks that fit while tick `now` is being put out.
  std::uint32_t room(std::uint64_t now) const {
    const std::uint64_t used = end_ > now ? end_ - now : 0;
    constexpr std::uint32_t usable = ring_ticks - 2 * ticks_per_step_word;
    return used < usable ? usable - static_cast<std::uint32_t>(used) : 0;
  }
  /// Where the axes stand when the ticks before `tick` have been put out; the tick must lie in
  /// the rings (main loop).
  StepPosition steps_at(std::uint64_t tick) const;

 private:
  /// The ring of an axis as it is being filled.
  struct Row {
    std::uint32_t place = 0;    ///< first tick not in it, from that of the first word on
    std::uint32_t partial = 0;  ///< the word being made, its ticks in the lower bits
    std::uint32_t dir = 0;      ///< all_dir_bits if the axis goes, or last went, backwards
  };

  std::uint32_t word_of(int axis, std::uint32_t place) const;

  LatticeRings& rings_;
  std::uint64_t end_ = 0;
  PerAxis<Row> rows_{};
  Row bits_;
  StepPosition steps_{};  ///< at end_
  PowerRing& power_;
  std::uint32_t power_place_ = 0;  ///< as in a Row, with the counts written ahead
};

}  // namespace lamplock::rp2040
