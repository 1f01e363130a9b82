// The second core: held off, started, or left alone.
//
// In:  the image's vectors, so that a fault there makes the outputs safe as one here does; where it
//      begins. Out: core 1 there, or that it does not answer.
// Who: the loader and start_second_core() on core 0; what core 1 does is the board's (board.hpp).
//
// A restart of core 0 alone (debugger) leaves core 1 running in memory that the loader is about to
// overwrite: it is reset first. A watchdog reset takes both.
//
// The ROM lets core 1 wait for six words in the FIFO between the cores and sends each back; what it
// sends back wrong begins the sequence anew (RP2040 datasheet, 2.8.2). Where there is no core 1, or
// a debugger holds it, the time runs out: then it is held in reset, for it must not begin later.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/psm.hpp"

namespace lamplock::rp2040 {

/// Core 1 stops at once, whatever it does.
[[gnu::always_inline]] inline void hold_second_core() { set_bits(psm().frce_off, psm_bit::proc1); }
/// It begins in the ROM, where it waits.
[[gnu::always_inline]] inline void release_second_core() {
  clear_bits(psm().frce_off, psm_bit::proc1);
}

/// Starts core 1 at `entry` with its stack empty; false if it does not answer, after two
/// milliseconds. Core 0 with interrupts on, once.
[[gnu::cold]] bool start_second_core(void (*entry)());

}  // namespace lamplock::rp2040
