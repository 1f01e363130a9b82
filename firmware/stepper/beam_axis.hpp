// The beam axis: switches a continuous laser cell by cell along a line.
//
// In:  segments that have a beam (SegmentBeam): the line is divided into cells of equal length, and
//      an axis of the segment gives the rate of cells. Powers of cells (PowerTable), or the length
//      of a pulse.
// Out: whether the laser is lit, its power, and for how many ticks both stay the same.
// Who: the tick generator, as its laser reader advances through a segment (fill interrupt). Budget:
//      none for segments without a beam; 900 cycles an edge of a cell, no division.
//
// Edges are steps of a separate axis, by Bresenham: its rate is the rate of the axis that it
// follows times cells per step, and the remainder at an edge is carried to the next. The tick of an
// edge is calculated: its bits, from the highest down, are as many sums over a run of constant
// acceleration. A change takes effect with the first tick that begins after the edge.
//
// Every segment contains its start position on this axis, so errors do not add up, and after a hold
// a line continues where it was. The number of a cell never decreases: where two segments differ by
// a rounding, no edge is passed twice or missed.
//
//   pixels   a cell shines with its power, in M4 times actual over programmed speed
//   pulses   at every edge a pulse begins; if the last one is not over, it is extended
//
// Edges that follow each other faster than 32 ticks are handled together: otherwise the board would
// have no time for other work.
#pragma once

#include <cstdint>

#include "firmware/stepper/power_table.hpp"
#include "firmware/stepper/segment.hpp"
#include "firmware/stepper/segment_power.hpp"

namespace lamplock::stepper {

class BeamAxis {
 public:
  /// Powers of cells.
  PowerTable& table() { return table_; }
  /// Length of a pulse, at least one tick; only while nothing moves.
  void set_pulse(std::uint32_t ticks) { pulse_ticks_ = ticks == 0 ? 1 : ticks; }
  /// Percentage of the powers of cells; takes effect at once.
  void set_percent(std::uint32_t percent) { percent_q14_ = (percent << percent_bits) / 100; }
  /// Pulses that began before the previous one was over.
  std::uint32_t merged() const { return merged_; }

  /// The laser enters a segment, which must stay in place meanwhile.
  void enter(const Segment& segment);
  /// The laser is in no segment.
  void leave() {
    kind_ = BeamKind::even;
    pulse_left_ = 0;
  }
  /// The segment has a beam, which decides what the laser does.
  bool active() const { return kind_ != BeamKind::even; }
  bool lit() const {
    return kind_ == BeamKind::even || (kind_ == BeamKind::pulses ? pulse_left_ : power_) != 0;
  }
  /// For how many of these ticks it stays lit or dark and its power changes evenly.
  std::uint32_t limit(std::uint32_t ticks) const {
    if (left_ < ticks) ticks = left_;
    return pulse_left_ != 0 && pulse_left_ < ticks ? pulse_left_ : ticks;
  }
  PowerStretch stretch() const;
  /// This many ticks, at most limit(), are over.
  void pass(std::uint32_t ticks) {
    if (pulse_left_ != 0) pulse_left_ -= ticks;
    left_ -= ticks;
    if (left_ == 0) change();
  }

 private:
  static constexpr int percent_bits = 14;

  void enter_pixels();
  void enter_pulses();
  bool next_piece();
  void find_edge();
  std::int64_t way_q48(std::uint32_t ticks) const;
  std::uint32_t ticks_to_q48(std::int64_t way_q48, std::uint32_t most) const;
  std::int64_t in_cells_q48(std::int64_t steps_q62) const;
  void change();
  void pass_edge();
  void seek(std::uint32_t cell);
  void begin_pulse();

  BeamKind kind_ = BeamKind::even;
  std::uint16_t power_ = 0;  ///< of the cell or the pulse
  const Segment* segment_ = nullptr;

  // Position and rate at the last change, `span_` ticks before the next.
  std::uint64_t place_q48_ = 0;  ///< cells, 16 bits of their number
  std::int64_t rate_q48_ = 0;    ///< added by the first tick, cells
  std::int64_t accel_q48_ = 0;
  std::uint32_t span_ = 0, left_ = 0;
  bool edge_ = false;             ///< an edge ends the span
  std::uint32_t since_edge_ = 0;  ///< ticks, up to the last change; no more than needed
  std::uint32_t piece_left_ = 0;  ///< ticks with this acceleration since the last change
  std::int64_t speed_q62_ = 0;    ///< of the axis at the end of the piece
  std::uint8_t phase_ = 0;        ///< lead, cruise, tail
  std::uint8_t stair_ = 0;        ///< next one
  bool backwards_ = false;

  // Pixels.
  std::uint16_t list_ = 0;     ///< list of the previous segment
  bool listed_ = false;        ///< the previous segment had a list
  std::uint16_t run_ = 0;      ///< index of the run that contains the cell
  std::uint32_t run_end_ = 0;  ///< first cell after it
  std::uint32_t cells_ = 0;    ///< cells in the list
  std::uint32_t percent_q14_ = 1u << percent_bits;
  PowerTable table_;

  // Pulses.
  std::uint32_t pulse_ticks_ = 1;
  std::uint32_t pulse_left_ = 0;
  std::uint8_t edges_ = 0;  ///< number of the last edge
  std::uint32_t merged_ = 0;
};

}  // namespace lamplock::stepper
