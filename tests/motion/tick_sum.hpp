// A profile summed tick by tick with the compiler's 128-bit integer: the definition that closed
// forms are tested against.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/stepper/segment.hpp"
#include "tests/native_int128.hpp"

namespace lamplock::test {

/// What a profile does, looked at after every tick.
struct TickSum {
  Native end_q62 = 0, lowest_q62 = 0, highest_q62 = 0;
  std::int64_t largest_speed_q62 = 0, largest_accel_q62 = 0;
  int sign_changes_outside_turns = 0;  ///< the rate may change sign only where the profile says
};

/// Calls `at(position_q62, speed_q62)` after every tick, position relative to the start.
template <class Visit>
void for_each_tick(const stepper::AxisProfile& p, Visit at) {
  struct Phase {
    std::int64_t accel;
    std::uint32_t ticks, turn;
  };
  const Phase phases[] = {{p.lead_accel_q62, p.lead_ticks, p.lead_turn_ticks},
                          {0, p.cruise_ticks, 0},
                          {p.tail_accel_q62, p.tail_ticks, p.tail_turn_ticks}};
  Native way = 0;
  std::int64_t speed = p.speed_q62;
  for (const Phase& phase : phases) {
    std::int64_t rate = speed + phase.accel / 2;
    for (std::uint32_t j = 0; j < phase.ticks; ++j) {
      way += rate;
      rate += phase.accel;
      speed += phase.accel;
      at(way, speed);
    }
  }
}

inline TickSum sum_ticks(const stepper::AxisProfile& p) {
  TickSum sum;
  sum.largest_speed_q62 = abs64(p.speed_q62);
  sum.largest_accel_q62 = std::max(p.lead_ticks != 0 ? abs64(p.lead_accel_q62) : 0,
                                   p.tail_ticks != 0 ? abs64(p.tail_accel_q62) : 0);
  std::uint32_t tick = 0;
  int sign = 0;
  Native before = 0;
  for_each_tick(p, [&](Native way, std::int64_t speed) {
    const int now = way > before ? 1 : way < before ? -1 : 0;
    const bool turn =
        tick == 0 || tick == p.lead_ticks || tick == p.lead_ticks + p.cruise_ticks ||
        (p.lead_turn_ticks != 0 && tick == p.lead_turn_ticks) ||
        (p.tail_turn_ticks != 0 && tick == p.lead_ticks + p.cruise_ticks + p.tail_turn_ticks);
    if (!turn && now * sign < 0) ++sum.sign_changes_outside_turns;
    if (now != 0 || turn) sign = now;
    sum.lowest_q62 = std::min(sum.lowest_q62, way);
    sum.highest_q62 = std::max(sum.highest_q62, way);
    sum.largest_speed_q62 = std::max(sum.largest_speed_q62, abs64(speed));
    before = way;
    ++tick;
  });
  sum.end_q62 = before;
  return sum;
}

}  // namespace lamplock::test
