// Converts runs of ticks to words for the state machines.
//
// In:  runs of each axis, of the lattice bits and of the laser's power, from the core's
//      fill_axes(); the meaning of the pins of each axis (pulse_words.hpp).
// Out: words in the LatticeRings, a fixed number of ticks each; counts of LASER PWM; how far the
//      rings are filled.
// Who: the fill interrupt (priority 3); begin() and steps_at() with that interrupt masked. Budget:
//      per axis and run some 200 cycles and at most 7 a tick, 2 where steps are rare; about a
//      quarter of a cycle a tick at rest. After a reversal close to a step some 200 cycles a tick
//      until its guard (stepper/reversal_guard.hpp) lets steps pass. For power 40 a call and half a
//      cycle a tick.
//
// A word is made of bits of DIR and STEP and is converted for the pins when it is complete.
//
// Power has one value per cell: that of the last lit tick up to its middle, or else of the first
// one after it. Where a dark gap divides a cell, such as after a pulse that ended a few ticks
// before its line, the power after the gap counts too if it is lower: no part is brighter than it
// should be.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/boards/rp2040/lattice/pulse_words.hpp"
#include "firmware/stepper/pulse_output.hpp"
#include "firmware/stepper/tick_block.hpp"

namespace lamplock::rp2040 {

/// Levels of the pins of BITS, one nibble a tick.
constexpr std::uint32_t lattice_nibble(std::uint8_t bits) {
  constexpr std::uint32_t trigger_pin = 1, gate_pin = 2, arm_pin = 4;
  return ((bits & stepper::trigger_bit) != 0 ? trigger_pin : 0) |
         ((bits & stepper::gate_bit) != 0 ? gate_pin : 0) |
         ((bits & stepper::arm_bit) != 0 ? arm_pin : 0);
}

class StepExpander {
 public:
  StepExpander(LatticeRings& rings, PowerRing& power) : rings_(rings), power_(power) {}

  /// Sets pins and drives; begin() must follow.
  [[gnu::cold]] void configure(const stepper::PulseOutput& output);
  /// Other times, while no step is in the rings; pins and their meaning stay.
  [[gnu::cold]] void set_times(const stepper::PulseOutput& output);
  bool has_times(const stepper::PulseOutput& output) const {
    return output.pulses == pulses_ && output.times == rows_[0].guard.times();
  }
  /// Starts again: the first word begins with tick `first`; up to the tick `filled`, where runs
  /// begin, all axes rest. `levels`: present levels of the pins of each axis (bit 0: STEP, CW or A;
  /// bit 1: DIR, CCW or B) without inversions: they do not change.
  [[gnu::cold]] void begin(std::uint64_t first, std::uint64_t filled, const StepPosition& steps,
                           const PerAxis<std::uint8_t>& levels = {});

  // Calls of fill_axes(); the caller has checked that there is room.
  void put_still(int axis, std::uint32_t ticks);
  void put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks);
  void put_bits(std::uint8_t bits, std::uint32_t ticks);
  void put_power(std::uint16_t power, std::uint32_t ticks);
  void set_step(int axis, std::int32_t step) { steps_[index(axis)] = step; }
  /// This many ticks of every axis and of the bits are complete.
  void end_runs(std::uint32_t ticks) { end_ += ticks; }

  /// First tick that is not filled.
  std::uint64_t end_tick() const { return end_; }
  /// Ticks that fit while tick `now` is being put out.
  std::uint32_t room(std::uint64_t now) const {
    const std::uint64_t used = end_ > now ? end_ - now : 0;
    constexpr std::uint32_t usable = ring_ticks - 2 * ticks_per_step_word;
    return used < usable ? usable - static_cast<std::uint32_t>(used) : 0;
  }
  /// First tick that is certainly still in the rings.
  std::uint64_t oldest_tick() const {
    constexpr std::uint32_t kept = ring_ticks - 2 * ticks_per_step_word;
    return end_ > kept ? end_ - kept : 0;
  }
  /// Position of the axes after the ticks before `tick` have been put out; the tick must be in the
  /// rings (main loop).
  [[gnu::cold]] StepPosition steps_at(std::uint64_t tick) const;
  /// The same for one axis: some 0.1 ms, twice that where every word has steps.
  [[gnu::cold]] std::int32_t step_at(int axis, std::uint64_t tick) const;

 private:
  /// The state of filling a ring.
  struct Fill {
    std::uint32_t place = 0;    ///< first tick not in it, from the start of the first word
    std::uint32_t partial = 0;  ///< the word being made, its ticks in the lower bits
  };
  /// State of an axis; `partial` has bits of DIR and STEP in every mode.
  struct Row {
    Fill fill;
    stepper::ReversalGuard guard;
    PulseMode mode = PulseMode::step_dir;
    std::uint8_t high_ticks = 0;  ///< of a pulse; 0: it ends within its tick
    bool plain = true;            ///< AXIS has the same words: STEP and DIR, short pulses
    /// At the end of the last complete word: levels of A and B, or the rest of a pulse.
    std::uint32_t levels = 0;

    std::uint32_t dir() const { return guard.back() ? all_dir_bits : 0; }
    std::uint32_t finish(std::uint32_t word) { return plain ? word : finish_other(word); }
    std::uint32_t finish_other(std::uint32_t word);
  };

  void put_other(int axis, const stepper::AxisRun& run, std::uint32_t ticks);
  template <bool plain>
  void put_words(int axis, StepPhase& phase, std::uint32_t dir, std::uint32_t ticks);
  bool turn_at_once(int axis, StepPhase phase, bool back, std::uint32_t ticks);
  std::uint32_t put_guarded(int axis, StepPhase& phase, bool back, bool is_standing_still,
                            std::uint32_t ticks);
  void put_guarded_tick(int axis, std::int32_t wanted);
  std::uint32_t steps_of(int axis, std::uint32_t place) const;
  std::uint32_t quiet_ticks(int axis) const;
  std::uint32_t quiet_words(int axis, std::uint32_t place, std::uint32_t ticks) const;

  LatticeRings& rings_;
  std::uint64_t end_ = 0;
  PerAxis<Row> rows_{};
  PulseTimes pulses_;
  Fill bits_;
  StepPosition steps_{};  ///< at end_
  PowerRing& power_;
  std::uint32_t power_place_ = 0;  ///< as in a Row, with the counts written ahead
  bool dark_ = true;               ///< the previous tick was dark
};

}  // namespace lamplock::rp2040
