// The cells along a line: pixels with a power each, or pulses.
//
// In:  the line under way; what is left of it where a segment begins.
// Out: the beam of the segment (stepper/segment.hpp), from which the tick generator finds the
// edges. Called by the line planner: begin() once a line, write() once a segment; for lines that
// have cells two quotients and three products, some 1000 cycles, and 300.
//
// Places are counted from the end of the line, which stays where it is, whatever became of the way
// to it: a line that is planned again from where the machine stands goes on in the cell that is
// there. Pixels end with their line. Pulses go on from line to line, as long as one follows the
// other; behind a rapid, or a line without pulses, the first one comes after half a distance.
#pragma once

#include <cstdint>

#include "firmware/motion/line_real.hpp"
#include "firmware/motion/line_ring.hpp"
#include "firmware/motion/line_segment.hpp"
#include "firmware/stepper/power_table.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

class LineBeam {
 public:
  /// What can be returned to.
  struct Place {
    LineReal per_length;        ///< cells
    std::uint32_t cells = 0;    ///< of pixels, all of them
    std::uint32_t end_q24 = 0;  ///< of pulses, where the line ends; or else the one before
    bool of_line = false;       ///< of the first line in the ring: it has begun, or was returned to
    bool apart = true;          ///< no line with pulses came before
    bool unseen = true;         ///< nor a segment that shone with them
  };

  /// Where lists of powers are.
  void set_powers(const stepper::PowerTable* powers) { powers_ = powers; }
  /// For lines that begin from now on.
  void set_pulses(LineReal per_length) { pulses_per_length_ = per_length; }
  /// Nothing came before.
  void forget() { place_ = {}; }

  const Place& place() const { return place_; }
  /// A line is to begin anew from elsewhere; its length as it was at that place.
  void return_to(const Place& place, const Line& line, LineReal length);

  /// A line begins; its longest axis.
  void begin(const Line& line, LineReal length, const LineWay& way, int longest);
  /// A segment of it, with so much of it left.
  void write(const Line& line, LineReal left, stepper::Segment& segment);
  /// The line is over.
  void end(const Line& line);

 private:
  void begin_place(const Line& line, LineReal length);

  const stepper::PowerTable* powers_ = nullptr;
  LineReal pulses_per_length_;
  Place place_;
  // The line under way.
  std::uint32_t ratio_ = 0;  ///< as in a SegmentBeam
  std::uint16_t cell_ticks_ = 0;
  std::uint8_t axis_ = 0;
};

}  // namespace lamplock::motion
