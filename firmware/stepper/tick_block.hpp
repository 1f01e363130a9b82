// A block of ticks: what the board turns into edges.
//
// In:  filled by the tick generator (fill interrupt). Out: read by the board, in the same call.
//
// In every block each axis has constant acceleration and does not change direction, and the lattice
// bits are constant; the power of a continuous laser changes evenly. A board that calculates the
// tick of each step by the closed form uses blocks; one that expands ticks (`phase += rate, rate +=
// accel`, the carry is a step) uses the same runs of each axis separately
// (TickGenerator::fill_axes()). Both give exactly the same steps at the same ticks.
#pragma once

#include <cstdint>

#include "shared/int128.hpp"
#include "shared/units.hpp"

namespace lamplock::stepper {

/// Outputs that change on the tick lattice.
enum LatticeBit : std::uint8_t {
  arm_bit = 1,      ///< the machine is in position for a shot
  trigger_bit = 2,  ///< lamp trigger (master)
  gate_bit = 4,     ///< a continuous laser may shine
};

/// Where the power of a continuous laser changes evenly, it is updated once per cell of this many
/// ticks, less than a step at 60 thousand steps a second. Its gate is exact to the tick.
inline constexpr std::uint32_t power_cell_ticks = 16;

/// One axis, or motor, in a block. Rate is added before the step is taken: tick j adds rate + j *
/// accel.
struct AxisRun {
  Int128 position_q64;         ///< at the start of the block; the upper half is the step
  std::int64_t rate_q62 = 0;   ///< added by the first tick; never changes sign inside a block
  std::int64_t accel_q62 = 0;  ///< added to the rate after every tick

  constexpr bool is_at_rest() const { return rate_q62 == 0 && accel_q62 == 0; }
  /// Its direction.
  constexpr bool backwards() const { return rate_q62 < 0 || (rate_q62 == 0 && accel_q62 < 0); }
  constexpr std::int32_t step() const { return static_cast<std::int32_t>(position_q64.hi()); }
  /// Position after n ticks, exact: n times the mean of first and last rate, whose sum is below two
  /// steps a tick.
  constexpr Int128 position_after(std::uint32_t n) const {
    if (n >> 16 != 0) {
      const auto triangle =
          static_cast<std::int64_t>(std::uint64_t{n} * (std::uint64_t{n} - 1) / 2);
      return position_q64 +
             ((Int128::product(rate_q62, n) + Int128::product(accel_q62, triangle)) << 2);
    }
    if (n == 0) return position_q64;
    const std::int64_t both = 2 * rate_q62 + short_product(accel_q62, n - 1);
    return position_q64 + (Int128::short_product(both, n) << 1);
  }
  /// The rate of the tick after the next n.
  constexpr std::int64_t rate_after(std::uint32_t n) const {
    return rate_q62 +
           (n >> 16 != 0 ? accel_q62 * static_cast<std::int64_t>(n) : short_product(accel_q62, n));
  }
};

/// Rounds a power with a fraction of 16 bits; it is at most 65535 as a whole.
constexpr std::uint16_t rounded_power(std::uint32_t power_q16) {
  return static_cast<std::uint16_t>((power_q16 + 0x8000u) >> 16);
}

/// The scale of 1 of the power of a continuous laser.
inline constexpr std::uint32_t full_scale_q15 = 1u << 15;
/// A power, 65535 = full, times a scale of at most 2, and at most full.
constexpr std::uint16_t scaled_power(std::uint16_t power, std::uint32_t scale_q15) {
  const std::uint32_t scaled = power * scale_q15 >> 15;
  return static_cast<std::uint16_t>(scaled < 0xffff ? scaled : 0xffff);
}

/// A run of ticks.
struct TickBlock {
  std::uint64_t first_tick = 0;
  std::uint32_t ticks = 0;
  std::uint8_t bits = 0;              ///< LatticeBit
  bool moving = false;                ///< some axis has a rate
  std::uint32_t power_q16 = 0;        ///< at the first tick, with gate_bit; 65535 = full
  std::uint32_t power_slope_q16 = 0;  ///< per tick, modulo 2^32
  std::uint32_t power_scale_q15 = full_scale_q15;
  PerAxis<AxisRun> axis{};  ///< of motors

  /// Power of tick n of the block, 65535 = full.
  constexpr std::uint16_t power(std::uint32_t n) const {
    return scaled_power(rounded_power(power_q16 + power_slope_q16 * n), power_scale_q15);
  }
};

}  // namespace lamplock::stepper
