// The beam axis: what a continuous laser does cell by cell along a line.
//
// In:  segments that have a beam (SegmentBeam): cells of equal length lie along the line, and an
//      axis of the segment tells how fast they pass. Powers of cells (PowerTable), or the length of
//      a pulse.
// Out: whether the laser is lit, with what power, and for how many ticks that stays so.
// Who: the tick generator, as its reader of power goes through a segment (fill interrupt). Budget:
//      nothing for segments without a beam; 900 cycles an edge of a cell, no division.
//
// Edges are steps of an axis of its own, by Bresenham: its rate is that of the axis that it follows
// times cells per step, and what is left over at an edge counts for the next. The tick of an edge
// is not waited for but found: its bits, from the highest down, are as many sums of a run of
// constant acceleration. A change is in force with the first tick that begins behind the edge.
//
// Every segment says where on the axis it begins, so nothing adds up, and a line goes on after a
// hold where it was. The number of a cell only ever grows: an edge is not passed twice, nor missed,
// where two segments differ by a rounding.
//
//   pixels   a cell shines with its power, in M4 times actual over programmed speed
//   pulses   at every edge a pulse begins; one that begins while another shines goes on from there
//
// Edges that come faster than one in 32 ticks are taken together: the board would have no time for
// anything else.
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
  /// How long a pulse is, one tick at least; while nothing moves.
  void set_pulse(std::uint32_t ticks) { pulse_ticks_ = ticks == 0 ? 1 : ticks; }
  /// Of the powers of cells; in force at once.
  void set_percent(std::uint32_t percent) { percent_q14_ = (percent << percent_bits) / 100; }
  /// Pulses that began before the one before was over.
  std::uint32_t merged() const { return merged_; }

  /// The laser goes into a segment, which stays where it is meanwhile.
  void enter(const Segment& segment);
  /// It is in none.
  void leave() {
    kind_ = BeamKind::even;
    pulse_left_ = 0;
  }
  /// The segment has a beam: what follows is its.
  bool active() const { return kind_ != BeamKind::even; }
  bool lit() const {
    return kind_ == BeamKind::even || (kind_ == BeamKind::pulses ? pulse_left_ : power_) != 0;
  }
  /// How many of these ticks it stays lit or dark, and its power changes evenly.
  std::uint32_t limit(std::uint32_t ticks) const {
    if (left_ < ticks) ticks = left_;
    return pulse_left_ != 0 && pulse_left_ < ticks ? pulse_left_ : ticks;
  }
  PowerStretch stretch() const;
  /// So many, no more than limit() says, are over.
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
  std::uint16_t power_ = 0;  ///< of the cell, or of a pulse
  const Segment* segment_ = nullptr;

  // Place and rate as they were at the last change, `span_` ticks before the next.
  std::uint64_t place_q48_ = 0;  ///< cells, 16 bits of their number
  std::int64_t rate_q48_ = 0;    ///< added by the first tick, cells
  std::int64_t accel_q48_ = 0;
  std::uint32_t span_ = 0, left_ = 0;
  bool edge_ = false;             ///< there is an edge at the end of it
  std::uint32_t since_edge_ = 0;  ///< ticks, up to the last change; not more than matters
  std::uint32_t piece_left_ = 0;  ///< ticks of the same acceleration from the last change on
  std::int64_t speed_q62_ = 0;    ///< of the axis at the end of the piece
  std::uint8_t phase_ = 0;        ///< lead, cruise, tail
  std::uint8_t stair_ = 0;        ///< which comes next
  bool backwards_ = false;

  // Pixels.
  std::uint16_t list_ = 0;     ///< that of the segment before
  bool listed_ = false;        ///< there was one
  std::uint16_t run_ = 0;      ///< place of the run that the cell is in
  std::uint32_t run_end_ = 0;  ///< first cell behind it
  std::uint32_t cells_ = 0;    ///< of the list
  std::uint32_t percent_q14_ = 1u << percent_bits;
  PowerTable table_;

  // Pulses.
  std::uint32_t pulse_ticks_ = 1;
  std::uint32_t pulse_left_ = 0;
  std::uint8_t edges_ = 0;  ///< number of the last one
  std::uint32_t merged_ = 0;
};

}  // namespace lamplock::stepper
