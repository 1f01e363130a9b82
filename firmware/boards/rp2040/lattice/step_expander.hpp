// From blocks of ticks to words for the state machines.
//
// In:  TickBlocks of the core, one behind the other.
// Out: words in the LatticeRings, a fixed number of ticks each; how far the rings are filled.
// Who: the fill interrupt (priority 3); begin() and steps_at() with that interrupt masked.
// Budget: 26 cycles a tick when four axes accelerate, about 1 when all stand, and some 100 cycles
//      per axis and block for the ends that do not fill a word.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/stepper/segment.hpp"
#include "firmware/stepper/tick_block.hpp"

namespace lamplock::rp2040 {

/// Levels of the pins of BITS, one nibble a tick.
constexpr std::uint32_t lattice_nibble(std::uint8_t bits) {
  constexpr std::uint32_t trigger_pin = 1, arm_pin = 4;
  return ((bits & stepper::trigger_bit) != 0 ? trigger_pin : 0) |
         ((bits & stepper::arm_bit) != 0 ? arm_pin : 0);
}

/// Fills the rings.
class StepExpander {
 public:
  explicit StepExpander(LatticeRings& rings) : rings_(rings) {}

  /// Starts anew: the first word begins with tick `first`; up to the tick `first_block`, where the
  /// next block begins, everything stands. A block that begins earlier is clipped (it stands too).
  void begin(std::uint64_t first, std::uint64_t first_block, const StepPosition& steps);
  /// Appends a block. The caller has made sure that there is room.
  void put(const stepper::TickBlock& block, const stepper::BitRuns& runs);
  /// The same with the block's bits all through.
  void put(const stepper::TickBlock& block);

  /// First tick that no block covers.
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
  void put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks);
  void put_still(int axis, std::uint32_t ticks);
  void put_bits(const stepper::BitRuns& runs, std::uint32_t skip);
  std::uint32_t word_of(int axis, std::uint32_t place) const;

  LatticeRings& rings_;
  std::uint64_t base_ = 0;  ///< tick that word 0 of the rings begins with, modulo their length
  std::uint64_t end_ = 0;
  std::uint32_t place_ = 0;           ///< end_ - base_, modulo the length of the rings
  PerAxis<std::uint32_t> partial_{};  ///< the word being made, its ticks in the lower bits
  std::uint32_t partial_bits_ = 0;
  PerAxis<std::uint32_t> dir_{};  ///< all_dir_bits if the axis goes, or last went, backwards
  stepper::TickBlock last_;
};

}  // namespace lamplock::rp2040
