// The path planner without a lamp: runs the lines of a program as fast as the machine can.
//
// In:  lines, one at a time (push), overrides, hold, resume, cancel.
// Out: segments for the tick generator, one at a time (next), and the laser's power over each.
// Who: the main loop, or the core that plans; push() and next() on the same core. Budget: 5000
//      lines of one segment a second on the Cortex-M0+, 20 thousand cycles each in total. Counted
//      with the divider of the RP2040, code in SRAM, three axes, no limit of jerk: 12.4 thousand at
//      a steady speed, 16 where every other line has a ramp, 26 where the whole ring is less than a
//      braking distance.
//
//   lines -> geometry -> ring -> look-ahead -> run -> segment
//            line/geometry.hpp   line/lookahead.hpp   line/segment.hpp
//            line/chords.hpp             line/profile.hpp
//
// The planned speed at the end of the ring is zero, so motion that is handed out can always be
// followed by braking along the lines in the ring. Later lines only make it faster. A segment is a
// slice of at most `slice_ticks`, and every slice is planned from the end of the last one, so an
// override takes effect with the next one: a machine that is too fast for it brakes as fast as it
// can. A hold stops on the path, if necessary inside a line, and resume() continues from there to
// the same end.
//
// Segments of next() may be late: the machine has then braked after the last segment that was in
// time. The caller takes a mark when it hands segments on, and can return to it:
//
//   mark()  next() next() next()  ...late, the machine brakes...  return_to(mark, where it rests)
//
// Then the lines are as they were at the mark, and the machine returns straight, as a rapid and
// dark, to its position at the mark, and continues from there: no part of the path is left out, and
// the laser is dark beside it.
//
// Lines end at the programmed place, to 1/256 step, and not in the middle of steps
// (line/place.hpp): the staircase of steps is within half a step of the line everywhere, and a
// machine at rest between two lines is inside the nearest step. Only after a cancel or a late
// segment does the machine move to the middle.
//
// Times: planned times are the ticks of segments, with no rounding after that; a line takes up to
// two ticks longer than it would without whole ticks (line/profile.hpp).
#pragma once

#include <cstdint>

#include "firmware/motion/line/beam.hpp"
#include "firmware/motion/line/chords.hpp"
#include "firmware/motion/line/join.hpp"
#include "firmware/motion/line/lookahead.hpp"
#include "firmware/motion/line/ring.hpp"
#include "firmware/motion/line/segment.hpp"
#include "firmware/motion/line/slice.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// A segment and the laser during it. Power changes evenly over lead and tail, 65535 is full; or
/// the segment has cells itself.
struct LineSegment {
  stepper::Segment segment;
  std::uint16_t power_start = 0;
  std::uint16_t power_cruise = 0;
  std::uint16_t power_end = 0;
  std::uint32_t line = 0;  ///< number of the target's line
  bool ends_line = false;  ///< the end of the segment is the target
  bool rapid = false;
  /// Belongs to no line: a move to the middle of a step after cancel() or return_to(), which may be
  /// longer than a slice, or the return to the path.
  bool settles = false;
};

class LinePlanner {
 public:
  /// The limits must stay in place; `limits` was made from `axes`. The ring is emptied.
  [[gnu::cold]] LinePlanner(LineRing& ring, const LineLimits& limits, const Limits& axes);

  /// Starts again from a state at rest, in the middle of its steps. `limits` may have changed.
  void start(const stepper::MotionState& at);

  /// Accepts a line; false if the ring is full. A line of no length only leaves its exact stop.
  bool push(const LineTarget& target);
  /// Makes the next segment; false if there is nothing to do: all lines are done, or the machine is
  /// held and at rest.
  bool next(LineSegment& out);

  /// A state to return to.
  struct Mark {
    std::uint32_t begin = 0;    ///< of the ring
    std::uint32_t forgets = 0;  ///< number of times that all lines were dropped before
    UFloat length;              ///< of the first line
    LinePlace place;            ///< where the path continues
    LineBeam::Place beam;
  };
  Mark mark() const;
  /// The machine rests at `at_rest`, anywhere, and segments made since the mark were not run. No
  /// line was pushed since. All lines are restored, the first one from its position at the mark (at
  /// the feed rate that follows from its time, if it is timed); overrides, hold and cancel set
  /// since are kept. The next segments move to the middle of the step and return to the path.
  [[gnu::cold]] void return_to(const Mark& mark, const stepper::MotionState& at_rest);

  /// Percent, 10 to 200; acts on motion that is not handed out. Never above the machine's limits.
  void set_feed_percent(std::uint32_t percent);
  /// 1 to 100.
  void set_rapid_percent(std::uint32_t percent);
  /// Pulses of lines that have them; for lines that have not begun.
  void set_pulses(UFloat per_length) { beam_.set_pulses(per_length); }
  /// Table of the lists of powers; to be set before a line has one.
  void set_powers(const stepper::PowerTable* powers) { beam_.set_powers(powers); }
  /// Stops on the path and stays there until resume().
  void hold() { held_ = true; }
  void resume() { held_ = cancelled_; }
  /// Stops and drops all lines; the hold ends then. No line may be pushed until idle().
  void cancel() { held_ = cancelled_ = true; }

  /// No motion follows the segments handed out, unless next() makes some.
  bool at_rest() const { return is_zero(speed_); }
  /// At rest, and nothing to do.
  bool idle() const { return at_rest() && ring_.empty() && !cancelled_ && !settles_; }
  bool held() const { return held_; }
  std::uint32_t free() const { return LineRing::capacity - ring_.size(); }
  std::uint32_t lines() const { return ring_.size(); }
  /// State at the end of all segments handed out.
  const stepper::MotionState& state() const { return at_; }

 private:
  void forget();
  void reset_chords();
  void begin_line();
  UFloat paced_speed(UFloat length);
  void count_line(bool joined);
  LineCorner corner_at_end(const Line& line, const LineShape& shape) const;
  void put(const LineTarget& target, const LineShape& shape, UFloat pace);
  bool continues(const LineTarget& target) const;
  bool join(const LineTarget& target, UFloat pace);
  void close_line();
  void cap(const LineCap& cap);
  LineTask task();
  UFloat task_speed(const Line& line, const LineTask& task) const;
  void write(const Line& line, const LineTask& task, const LineRun& run, LineSegment& out);
  [[gnu::cold]] void measure_again();
  bool end_cancel(LineSegment& out);
  bool settle(LineSegment& out);
  std::uint32_t settling_ticks() const;
  std::uint16_t power(const Line& line, UFloat speed) const;
  void advance(const LineRun& run);

  LineRing& ring_;
  const LineLimits& limits_;
  const Limits& axes_;
  LineOverride factor_;
  LineLookahead lookahead_;
  bool held_ = false, cancelled_ = false;
  bool settles_ = false;       ///< must move to the middle of the step first
  bool returns_ = false;       ///< then to `back_`: the present line leads there
  std::uint32_t forgets_ = 0;  ///< number of times that all lines were dropped

  // The end of the ring.
  LinePlace end_;
  LineShape last_;                 ///< of the last line; no length = none
  LineShape before_;               ///< of the one before it
  bool stop_ = false;              ///< at the end of the last line
  bool joint_stops_ = false;       ///< at its start
  bool open_ = false;              ///< targets may still extend the last line
  bool clear_ = false;             ///< the corner at its start is clearly one
  std::uint32_t feed_um_min_ = 0;  ///< of the last line, as programmed
  LineJoin join_;
  UFloat pace_;    ///< paced_speed() of the previous line
  UFloat recent_;  ///< mean length of the last lines, times their number
  /// mean of their minimum ticks, times another number
  std::uint32_t recent_ticks_ = 0;
  LineChords short_chords_, long_chords_, gentle_chords_;

  LinePlace back_;  ///< where the machine left the path

  // The present line: the first in the ring.
  stepper::MotionState at_;
  UFloat speed_;  ///< along it
  bool begun_ = false;
  bool whole_ = false;  ///< none of it is done
  LineWay way_;
  UFloat length_;
  LineBeam beam_;
  int dominant_axis_ = 0;
  UFloat time_left_;  ///< ticks at 100 %, if it is timed
};

}  // namespace lamplock::motion
