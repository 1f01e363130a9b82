// Watchdog, its scratch registers and the tick generator (RP2040 datasheet, 4.7.6).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct WatchdogRegisters {
  Register ctrl;
  Register load;  ///< 24 bits; counts down twice a tick (erratum E1)
  Register reason;
  Register scratch[8];  ///< survive a watchdog reset; the ROM reads 4 to 7
  Register tick;
};
static_assert(offsetof(WatchdogRegisters, scratch) == 0xc);
static_assert(offsetof(WatchdogRegisters, tick) == 0x2c);

inline WatchdogRegisters& watchdog_registers() {
  return *reinterpret_cast<WatchdogRegisters*>(0x40058000);
}

namespace watchdog_field {
inline constexpr std::uint32_t trigger = 1u << 31;      // CTRL
inline constexpr std::uint32_t enable = 1u << 30;       // CTRL
inline constexpr std::uint32_t pause_debug = 7u << 24;  // CTRL: core 0, core 1, JTAG
inline constexpr std::uint32_t reason_timer = 1u << 0;  // REASON
inline constexpr std::uint32_t reason_force = 1u << 1;  // REASON
inline constexpr std::uint32_t tick_enable = 1u << 9;   // TICK, with cycles a tick below
}  // namespace watchdog_field

}  // namespace lamplock::rp2040
