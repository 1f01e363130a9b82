// Interface of the PIO blocks and the DMA to the owner of their clock.
//
// In:  accesses to their registers. Out: the clocks up to the present (PioDmaClock).
#pragma once

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// Owner of the clock of the PIO blocks and the DMA.
class ClockOwner {
 public:
  virtual ~ClockOwner() = default;
  /// A register is about to be read or written: brings the blocks up to the present. Returns the
  /// first clock that has not been run.
  virtual Cycle bring_up_to_date() = 0;
  /// An access has changed when the blocks are due.
  virtual void changed() = 0;
};

}  // namespace lamplock::sim::chip
