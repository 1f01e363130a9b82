// The second core: held in reset, started, or left alone.
//
// In:  the image's vectors, so that a fault on core 1 makes the outputs safe like one on core 0;
//      its entry point. Out: core 1 running, or that it does not answer.
// Who: the loader and start_second_core() on core 0; the board defines what core 1 runs
//      (board.hpp).
//
// A restart of core 0 alone (debugger) leaves core 1 running in memory that the loader is about to
// overwrite: it is reset first. A watchdog reset restarts both.
//
// On core 1 the ROM waits for six words in the FIFO between the cores and echoes each; a wrong echo
// restarts the sequence (RP2040 datasheet, 2.8.2). Without a core 1, or if a debugger holds it, the
// time runs out: then it is held in reset, because it must not start later.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/psm.hpp"

namespace lamplock::rp2040 {

/// Stops core 1 at once.
[[gnu::always_inline]] inline void hold_second_core() { set_bits(psm().frce_off, psm_bit::proc1); }
/// Core 1 starts in the ROM, where it waits.
[[gnu::always_inline]] inline void release_second_core() {
  clear_bits(psm().frce_off, psm_bit::proc1);
}

/// Starts core 1 at `entry` with its stack empty; false if it does not answer within two
/// milliseconds. Core 0 with interrupts enabled, once.
[[gnu::cold]] bool start_second_core(void (*entry)());

}  // namespace lamplock::rp2040
