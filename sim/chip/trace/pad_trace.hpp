// Trace of all GPIO pads of a chip as a Value Change Dump: gpio0 to gpio29.
//
// In:  the pads. Out: text on a stream (vcd_file.hpp). Who: the owner of the chip, who calls
//      flush() now and then after gpio().catch_up(), and finish() at the end. Listens from
//      construction on.
#pragma once

#include <ostream>

#include "sim/chip/chip.hpp"
#include "sim/trace/vcd_file.hpp"

namespace lamplock::sim::chip {

/// One trace; must live as long as the chip runs.
class PadTrace final : private PadListener {
 public:
  PadTrace(std::ostream& out, Chip& chip);
  PadTrace(const PadTrace&) = delete;
  PadTrace& operator=(const PadTrace&) = delete;

  void flush(Picoseconds up_to) { file_.flush(up_to); }
  void finish(Picoseconds end) { file_.finish(end); }

 private:
  void pad_changed(unsigned gpio, bool level, Cycle at) override {
    file_.change(gpio, level, wheel_.time_of(at));
  }
  const TimeWheel& wheel_;
  VcdFile file_;
};

}  // namespace lamplock::sim::chip
