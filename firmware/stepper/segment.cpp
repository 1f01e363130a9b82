#include "firmware/stepper/segment.hpp"

namespace lamplock::stepper {

Ramp ramp_of(std::uint32_t n, std::uint8_t ramp) {
  if (ramp == falling_ramp) return {max_log_stairs, n >> max_log_stairs};
  const auto r = static_cast<std::uint32_t>(wide_product(n, ramp) >> 8);
  int log_stairs = 0;
  while (log_stairs < max_log_stairs && r >> (log_stairs + 1) >= min_stair_ticks) ++log_stairs;
  return {log_stairs, r >> log_stairs};
}

std::uint32_t pulse_ticks(std::uint32_t n, std::uint8_t ramp) {
  return ramp == falling_ramp ? n / 2 : n - ramp_of(n, ramp).ticks();
}

bool next_ramp_stair(std::int64_t accel_q62, std::uint32_t n, std::uint8_t ramp, std::uint32_t i,
                     Stair& stair) {
  const Ramp shape = ramp_of(n, ramp);
  const std::uint32_t top = shape.stairs();
  if (i > 2 * top) return false;
  if (i == top) {
    stair = {accel_q62, ramp == falling_ramp ? 0 : n - 2 * shape.ticks()};
    return true;
  }
  const std::uint32_t halves = 2 * (i < top ? i : 2 * top - i) + 1;
  stair = {(accel_q62 >> (shape.log_stairs + 1)) * static_cast<std::int64_t>(halves),
           shape.stair_ticks};
  return true;
}

std::int64_t straight_ramp_q62(std::int64_t accel_q62, std::uint32_t n, std::uint8_t ramp,
                               std::uint32_t i, std::uint32_t ticks_left) {
  Stair stair;
  if (!next_ramp_stair(accel_q62, n, ramp, i, stair)) return 0;
  const Ramp shape = ramp_of(n, ramp);
  if (i == shape.stairs() || stair.ticks == 0) return stair.accel_q62;
  // The stair differs from the ramp by half a stair at its ends and by nothing in its middle.
  const std::int64_t half = accel_q62 >> (shape.log_stairs + 1);
  const std::int64_t from_middle = std::int64_t{stair.ticks} - 2 * std::int64_t{ticks_left};
  const std::int64_t climbed = mul_div(half, from_middle, stair.ticks);
  return stair.accel_q62 + (i < shape.stairs() ? climbed : -climbed);
}

Int128 ramp_displacement_q62(std::int64_t speed_q62, std::int64_t accel_q62, std::uint32_t n,
                             std::uint8_t ramp) {
  const Int128 steady = Int128::product(speed_q62, n);
  if (accel_q62 == 0) return steady;
  // A n (n - r) / 2; the stairs of a fall: A s^2 (4 K^2 - 1)/12 with K = 4.
  static_assert(max_log_stairs == 2);
  const std::uint64_t quarters = ramp == falling_ramp ? 21 * wide_product(n / 4, n / 4)
                                                      : 2 * wide_product(n, full_ticks(n, ramp));
  return steady + (Int128::product(accel_q62, static_cast<std::int64_t>(quarters)) >> 2);
}

}  // namespace lamplock::stepper
