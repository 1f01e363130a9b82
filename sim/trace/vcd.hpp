// Trace of all wires between a board and the world, as a Value Change Dump.
//
// In:  every change on the bus. Boards deliver a slice of time axis by axis; the file sorts.
// Out: text on a stream (vcd_file.hpp).
// Who: listens to the bus. The owner of the trace may call flush() and must destroy it, or call
//      finish(), before the stream is destroyed.
#pragma once

#include <cstdint>
#include <ostream>

#include "sim/trace/vcd_file.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// Writes a VCD file; must live as long as the bus is driven.
class VcdWriter final : public PinListener {
 public:
  /// Writes the header with the present levels and listens from then on.
  VcdWriter(std::ostream& out, PinBus& bus);
  VcdWriter(const VcdWriter&) = delete;
  VcdWriter& operator=(const VcdWriter&) = delete;
  ~VcdWriter() override;

  /// No change before `up_to` will come any more: writes all earlier ones.
  void flush(Picoseconds up_to) { file_.flush(up_to); }

  /// Writes the rest and, if later than the last change, the end of time `end`.
  void finish(Picoseconds end = 0) { file_.finish(end); }

  /// Changes that came after their time had been written; they appear at the time reached.
  std::uint64_t late_changes() const { return file_.late_changes(); }

  void pin_changed(Pin pin, bool level, Picoseconds at) override;

 private:
  VcdFile file_;
};

}  // namespace lamplock::sim
