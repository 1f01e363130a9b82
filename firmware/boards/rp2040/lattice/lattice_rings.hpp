// The rings between fill interrupt and DMA: steps of four axes, lattice bits, the power of a
// continuous laser.
//
// In:  words of the StepExpander.
// Out: the same words, read by DMA continuously.
// Size: 4096 ticks. Motion is filled 2 ms ahead of the ticks that have a length, which are less
// than 1 ms ahead of time; played ticks remain in the rings long enough for an e-stop to count the
// steps put out.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/base/laser_pwm.hpp"
#include "firmware/boards/rp2040/lattice/step_kernel.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

inline constexpr std::uint32_t ring_ticks = 4096;
inline constexpr std::uint32_t ticks_per_bits_word = 8;
inline constexpr std::uint32_t step_ring_words = ring_ticks / ticks_per_step_word;
inline constexpr std::uint32_t bits_ring_words = ring_ticks / ticks_per_bits_word;
/// Powers of two, in bytes, for the DMA's address wrap; the alignment it needs.
inline constexpr unsigned step_ring_bits = 10;
inline constexpr unsigned bits_ring_bits = 11;
static_assert(step_ring_words * 4 == 1u << step_ring_bits);
static_assert(bits_ring_words * 4 == 1u << bits_ring_bits);

/// Read-ahead of the state machines: eight words of FIFO and one being shifted.
inline constexpr std::uint32_t prefetch_ticks = 9 * ticks_per_step_word;
static_assert(prefetch_ticks == 144);

/// As long as the others, an element per cell of the lattice: counts of LASER PWM at the place
/// where they are written (laser_pwm.hpp).
inline constexpr std::uint32_t power_ring_cells = ring_ticks / stepper::power_cell_ticks;
inline constexpr unsigned power_ring_bits = 9;
static_assert(power_ring_cells * 2 == 1u << power_ring_bits);
inline constexpr std::uint32_t bits_words_per_cell =
    stepper::power_cell_ticks / ticks_per_bits_word;

struct alignas(1u << power_ring_bits) PowerRing {
  std::array<std::uint16_t, power_ring_cells> counts{};
};

struct alignas(1u << bits_ring_bits) LatticeRings {
  std::array<std::uint32_t, bits_ring_words> bits{};
  PerAxis<std::array<std::uint32_t, step_ring_words>> steps{};
};

}  // namespace lamplock::rp2040
