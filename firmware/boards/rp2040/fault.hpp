// The fault handler: outputs off, what happened kept, restart.
//
// Who: hardware, for HardFault and for every exception and interrupt that nobody expects.
#pragma once

namespace lamplock::rp2040 {

/// Everything that can release energy low at its pad, no further tick: stores only. Any level.
void make_outputs_safe();

}  // namespace lamplock::rp2040

extern "C" void fault_entry();
