// The fault handler: switches outputs off, records the fault, restarts.
//
// Who: hardware, for HardFault and for every exception and interrupt without another handler.
#pragma once

namespace lamplock::rp2040 {

/// All outputs that can release energy low at their pads, no further tick: only stores. Any level.
void make_outputs_safe();

}  // namespace lamplock::rp2040

extern "C" void fault_entry();
