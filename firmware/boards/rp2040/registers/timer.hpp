// Microsecond timer (RP2040 datasheet, 4.6.5).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct TimerRegisters {
  Register timehw;
  Register timelw;
  Register timehr;
  Register timelr;
  Register alarm[4];
  Register armed;
  Register timerawh;
  Register timerawl;
  Register dbgpause;
  Register pause;
  Register intr;
  Register inte;
  Register intf;
  Register ints;
};
static_assert(offsetof(TimerRegisters, alarm) == 0x10);
static_assert(offsetof(TimerRegisters, timerawh) == 0x24);
static_assert(offsetof(TimerRegisters, timerawl) == 0x28);
static_assert(offsetof(TimerRegisters, ints) == 0x40);

inline TimerRegisters& timer() { return *reinterpret_cast<TimerRegisters*>(0x40054000); }

/// Microseconds since the timer left reset. Unlike TIMEHR/TIMELR it may be read at any level.
inline std::uint64_t microseconds() {
  std::uint32_t high = timer().timerawh;
  for (;;) {
    const std::uint32_t low = timer().timerawl;
    const std::uint32_t again = timer().timerawh;
    if (again == high) return (std::uint64_t{high} << 32) | low;
    high = again;
  }
}

}  // namespace lamplock::rp2040
