// The cells along a line: pixels with a power each, or pulses.
//
// In:  the present line; the rest of it at the start of a segment.
// Out: the beam of the segment (stepper/segment.hpp), from which the tick generator finds the
//      edges.
// Who: the line planner: begin() once a line, write() once a segment; for lines that have cells two
//      quotients and three products, some 1000 cycles, and 300.
//
// Places are counted from the end of the line, which is constant, however the machine gets there: a
// line that is planned again from where the machine rests continues in the cell at that place.
// Pixels end with their line. Pulses continue from line to line; after a rapid, or a line without
// pulses, the first one follows after half a distance.
#pragma once

#include <cstdint>

#include "firmware/motion/line/real.hpp"
#include "firmware/motion/line/ring.hpp"
#include "firmware/motion/line/segment.hpp"
#include "firmware/stepper/power_table.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

class LineBeam {
 public:
  /// State to return to.
  struct Place {
    UFloat per_length;          ///< cells
    std::uint32_t cells = 0;    ///< of pixels: number in the line
    std::uint32_t end_q24 = 0;  ///< of pulses: phase at the end of the line, or of the previous one
    bool of_line = false;       ///< belongs to the first line in the ring: begun, or returned to
    bool apart = true;          ///< the previous line had no pulses
    bool unseen = true;         ///< nor had a segment that shone
  };

  /// Table of the lists of powers.
  void set_powers(const stepper::PowerTable* powers) { powers_ = powers; }
  /// For lines that begin from now on.
  void set_pulses(UFloat per_length) { pulses_per_length_ = per_length; }
  /// Forgets the previous lines.
  void forget() { place_ = {}; }

  const Place& place() const { return place_; }
  /// The line begins again elsewhere; its length as it was at that place.
  void return_to(const Place& place, const Line& line, UFloat length);

  /// A line begins; `longest`: its longest axis.
  void begin(const Line& line, UFloat length, const LineWay& way, int longest);
  /// Writes a segment of the line, with this length of it left.
  void write(const Line& line, UFloat left, stepper::Segment& segment);
  /// The line is over.
  void end(const Line& line);

 private:
  void begin_place(const Line& line, UFloat length);

  const stepper::PowerTable* powers_ = nullptr;
  UFloat pulses_per_length_;
  Place place_;
  // The present line.
  std::uint32_t ratio_ = 0;  ///< as in a SegmentBeam
  std::uint16_t cell_ticks_ = 0;
  std::uint8_t axis_ = 0;
};

}  // namespace lamplock::motion
