// Trace of all wires as a Value Change Dump (IEEE 1364-2005, clause 18), for GTKWave and others.
//
// In:  every change on the bus. Boards deliver a slice of time axis by axis, so changes are kept
//      and sorted before they are written.
// Out: text on a stream, timescale 1 ps, the same bytes for the same run.
// Who: listens to the bus; whoever owns the trace may call flush() and must destroy it, or call
//      finish(), before the stream goes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// Writes a VCD file; must live as long as the bus is driven.
class VcdWriter final : public PinListener {
 public:
  /// Writes the header with the present levels and listens from now on.
  VcdWriter(std::ostream& out, PinBus& bus);
  VcdWriter(const VcdWriter&) = delete;
  VcdWriter& operator=(const VcdWriter&) = delete;
  ~VcdWriter() override;

  /// No change before `up_to` will come any more: writes all of those.
  void flush(Picoseconds up_to);

  /// Writes the rest and, if later than the last change, the end of time `end`.
  void finish(Picoseconds end = 0);

  /// Changes that came after their time had been written; they appear at the time reached.
  std::uint64_t late_changes() const { return late_; }

  void pin_changed(Pin pin, bool level, Picoseconds at) override;

 private:
  struct Change {
    Picoseconds at;
    Pin pin;
    bool level;
  };
  void write_header(const PinBus& bus);
  void write_until(std::size_t count);
  void write_time(Picoseconds at);

  std::ostream& out_;
  std::vector<Change> pending_;
  std::size_t flush_size_;
  Picoseconds newest_ = 0;
  Picoseconds written_to_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace lamplock::sim
