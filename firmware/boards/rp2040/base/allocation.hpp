// Allocation of state machines, DMA channels and alarms: one table, so that none is used twice.
// Interrupts and their priorities: interrupts.hpp.
//
//   state machines   PIO0: AXIS X, Y, Z, FIRE         PIO1: AXIS A, BITS, TICK, STAMP
//   DMA channels     0-3 AXIS, 4 BITS, 5 TICK, 6 STAMP, 7 starts any of them again,
//                    8 LASER PWM, in turn with BITS; 11 checks planners
//   alarms           1: lengths of ticks, tokens
#pragma once

#include "firmware/boards/rp2040/pio/state_machine.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

inline constexpr PerAxis<pio::StateMachine> axis_machines{{{0, 0}, {0, 1}, {0, 2}, {1, 0}}};
inline constexpr pio::StateMachine fire_machine{0, 3};
inline constexpr pio::StateMachine bits_machine{1, 1};
inline constexpr pio::StateMachine tick_machine{1, 2};
inline constexpr pio::StateMachine stamp_machine{1, 3};

inline constexpr unsigned bits_channel = 4;  // 0 to 3: axes
inline constexpr unsigned tick_channel = 5;
inline constexpr unsigned stamp_channel = 6;
inline constexpr unsigned again_channel = 7;
inline constexpr unsigned power_channel = 8;
inline constexpr unsigned check_channel = 11;

inline constexpr unsigned beat_alarm = 1;

}  // namespace lamplock::rp2040
