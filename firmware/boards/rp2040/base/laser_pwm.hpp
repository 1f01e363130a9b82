// LASER PWM driven by the lattice: period, counts, and the time of writing them.
//
// In:  powers, 65535 = full. Out: counts high of a period. No registers: the expander makes the
//      counts (fill interrupt), DMA writes them, the attenuator of a pulsed laser uses the same.
//
// A period is as long as a cell of the lattice while ticks have their nominal length, and both
// begin together (RealTime::go()): then each cell has its own period. A written count takes effect
// with the next period, so DMA writes in the middle of the previous cell: up to seven ticks sooner
// or later the period is the same. Where the lattice is slewed to a lamp the two drift, and power
// changes up to half a period beside its cell.
//
// DMA writes two words, a cell of ticks, to BITS, then a count to LASER PWM, and so on: the count
// follows the words and needs no other clock. BITS holds nine words (FIFO and the one being
// shifted); it pulls the word 2j - 7 with the last tick of the previous one, and then DMA writes
// word 2j + 1 and count j:
//
//   tick 16j - 57            16j - 48             16j - 32
//   count j is written       a period begins      and ends       so count j is that of cell j - 3
#pragma once

#include <array>
#include <cstdint>

#include "firmware/stepper/tick_block.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

/// 62.5 kHz.
inline constexpr std::uint32_t laser_pwm_counts = stepper::power_cell_ticks * clocks_per_tick;

/// Counts high for a power or a value of the attenuator: 65535 is always high.
constexpr std::uint16_t laser_duty(std::uint16_t power) {
  return static_cast<std::uint16_t>((std::uint32_t{power} * laser_pwm_counts + 0x8000u) >> 16);
}
static_assert(laser_duty(65535) == laser_pwm_counts && laser_duty(0) == 0 &&
              laser_duty(32768) == laser_pwm_counts / 2);

/// Number of counts written before that of the first cell.
inline constexpr std::uint32_t power_ahead_cells = 3;

}  // namespace lamplock::rp2040
