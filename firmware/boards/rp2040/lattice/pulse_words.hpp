// Converts bits of DIR and STEP to the levels of the two pins of an axis, and back.
//
// In:  words of 16 ticks x (DIR, STEP), the first tick in the two uppermost bits (step_kernel.hpp).
// Out: words of the same format for AXIS: the upper bit of a tick is for the pin of DIR, CCW or B,
//      the lower one for that of STEP, CW or A.
// Who: StepExpander (fill interrupt); the reverse also where it counts the steps put out. Cost on
//      the Cortex-M0+: nothing for STEP and DIR; at 250 kHz some 50 cycles a word for CW and CCW,
//      90 for A and B (measured on the chip simulator).
//
// With the tick line AXIS lowers the pins of short pulses: STEP, or both of CW and CCW. Longer
// pulses last whole ticks, and A and B keep their levels until the next step: AXIS lowers nothing.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/lattice/step_kernel.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::rp2040 {

using settings::PulseMode;

/// For every tick the exclusive or of all up to it, upper and lower bits separately.
constexpr std::uint32_t changes_so_far(std::uint32_t word) {
  word ^= word >> 2;
  word ^= word >> 4;
  word ^= word >> 8;
  return word ^ word >> 16;
}

/// A (lower) and B (upper bit) at the ticks of a word; `levels`: those before the word, updated to
/// its end. Every step changes one of the two: upwards A where they are equal, B where they differ,
/// downwards the reverse.
constexpr std::uint32_t quadrature_word(std::uint32_t word, std::uint32_t& levels) {
  const std::uint32_t held = levels * all_step_bits;
  const std::uint32_t step = word & all_step_bits;
  if (step == 0) return held;
  const std::uint32_t differ = (changes_so_far(step) ^ step ^ held ^ held >> 1) & all_step_bits;
  const std::uint32_t second = differ ^ (word >> 1 & all_step_bits);
  const std::uint32_t put = held ^ changes_so_far((step & ~second) | (step & second) << 1);
  levels = put & 3;
  return put;
}

/// Pulses of `high_ticks` ticks, at most a word, from those of one tick; they are further apart
/// than that. `rest`: the ticks of the last pulse that belong to the next word.
constexpr std::uint32_t long_pulses(std::uint32_t pulses, std::uint32_t high_ticks,
                                    std::uint32_t& rest) {
  std::uint32_t put = pulses | rest;
  rest = 0;
  if (pulses == 0) return put;
  for (std::uint32_t shift = 2; shift != 2 * high_ticks; shift += 2) {
    put |= pulses >> shift;
    rest |= pulses << (32 - shift);
  }
  return put;
}

/// Converts a word of (DIR, STEP) for AXIS. `levels`: in quadrature those before the word,
/// otherwise what long_pulses() has left.
constexpr std::uint32_t pulse_word(PulseMode mode, std::uint32_t high_ticks, std::uint32_t word,
                                   std::uint32_t& levels) {
  if (mode == PulseMode::quadrature) return quadrature_word(word, levels);
  std::uint32_t pulses = word & all_step_bits, others = word & all_dir_bits;
  if (mode == PulseMode::cw_ccw) {
    pulses = (word & ~(word >> 1) & all_step_bits) | (word & word << 1 & all_dir_bits);
    others = 0;
  }
  return others | (high_ticks == 0 ? pulses : long_pulses(pulses, high_ticks, levels));
}

/// Converts a word of AXIS back to (DIR, STEP), `levels` being those before it; DIR is undefined in
/// ticks without a step.
constexpr std::uint32_t step_word(PulseMode mode, std::uint32_t high_ticks, std::uint32_t word,
                                  std::uint32_t levels) {
  const std::uint32_t before = word >> 2 | levels << 30;
  const std::uint32_t begun = high_ticks == 0 ? word : word & ~before;
  if (mode == PulseMode::step_dir) return (word & all_dir_bits) | (begun & all_step_bits);
  if (mode == PulseMode::cw_ccw) return begun | (begun >> 1 & all_step_bits);
  const std::uint32_t change = word ^ before;
  const std::uint32_t back = change >> 1 ^ before ^ before >> 1;
  return ((change | change >> 1) & all_step_bits) | (back & all_step_bits) << 1;
}

}  // namespace lamplock::rp2040
