// A profile summed tick by tick with the compiler's 128-bit integer: the reference for tests of
// closed forms.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/stepper/segment.hpp"
#include "tests/native_int128.hpp"

namespace lamplock::test {

/// Results of a profile, evaluated after every tick.
struct TickSum {
  Native end_q62 = 0, min_q62 = 0, max_q62 = 0;
  std::int64_t max_speed_q62 = 0, max_accel_q62 = 0;
  int sign_changes_outside_turns = 0;  ///< the rate may change sign only where the profile allows
};

/// Acceleration of tick j of a phase of n ticks, by definition: constant, or in K stairs of s ticks
/// up to `accel` and down again, stair i of them (i - 1/2) / K high.
inline std::int64_t accel_at(std::int64_t accel, std::uint32_t n, std::uint8_t ramp,
                             std::uint32_t j) {
  if (ramp == 0) return accel;
  const stepper::Ramp shape = stepper::ramp_of(n, ramp);
  const std::uint32_t from_end = n - 1 - j;
  const std::uint32_t near = ramp == stepper::falling_ramp ? from_end : std::min(j, from_end);
  const std::uint32_t stair = near / shape.stair_ticks;
  if (stair >= shape.stairs()) return accel;
  return accel / (2 * shape.stairs()) * (2 * static_cast<std::int64_t>(stair) + 1);
}

/// Calls `at(position_q62, speed_q62, accel_q62)` after every tick, position relative to the start.
template <class Visit>
void for_each_tick(const stepper::AxisProfile& p, Visit at) {
  struct Phase {
    std::int64_t accel;
    std::uint32_t ticks;
    std::uint8_t ramp;
  };
  const Phase phases[] = {{p.lead_accel_q62, p.lead_ticks, p.lead_ramp},
                          {0, p.cruise_ticks, 0},
                          {p.tail_accel_q62, p.tail_ticks, p.tail_ramp}};
  Native way = 0;
  std::int64_t speed = p.speed_q62;
  for (const Phase& phase : phases) {
    for (std::uint32_t j = 0; j < phase.ticks; ++j) {
      const std::int64_t accel = accel_at(phase.accel, phase.ticks, phase.ramp, j);
      way += speed + accel / 2;
      speed += accel;
      at(way, speed, accel);
    }
  }
}

inline TickSum sum_ticks(const stepper::AxisProfile& p) {
  TickSum sum;
  sum.max_speed_q62 = abs64(p.speed_q62);
  std::uint32_t tick = 0;
  int sign = 0;
  Native before = 0;
  std::int64_t last_accel = 0;
  for_each_tick(p, [&](Native way, std::int64_t speed, std::int64_t accel) {
    const int now = way > before ? 1 : way < before ? -1 : 0;
    const bool turn =
        tick == 0 || accel != last_accel || tick == p.lead_ticks ||
        tick == p.lead_ticks + p.cruise_ticks ||
        (p.lead_turn_ticks != 0 && tick == p.lead_turn_ticks) ||
        (p.tail_turn_ticks != 0 && tick == p.lead_ticks + p.cruise_ticks + p.tail_turn_ticks);
    if (!turn && now * sign < 0) ++sum.sign_changes_outside_turns;
    if (now != 0 || turn) sign = now;
    sum.min_q62 = std::min(sum.min_q62, way);
    sum.max_q62 = std::max(sum.max_q62, way);
    sum.max_speed_q62 = std::max(sum.max_speed_q62, abs64(speed));
    sum.max_accel_q62 = std::max(sum.max_accel_q62, abs64(accel));
    before = way;
    last_accel = accel;
    ++tick;
  });
  sum.end_q62 = before;
  return sum;
}

}  // namespace lamplock::test
