// The path planner without a lamp: lines of a program, run as fast as the machine can.
//
// In:  lines, one at a time (push), overrides, hold, resume, cancel.
// Out: segments for the tick generator, one at a time (next), and the laser's power over each.
// Called by the main loop, or the core that plans; push() and next() by the same one. Budget: 5000
// lines of one segment a second on the Cortex-M0+, 20 thousand cycles each, all told. Counted with
// the divider of the RP2040, code in SRAM, three axes, no limit of jerk: 12.4 thousand at a steady
// speed, 16 where every other line has a ramp, 26 where the whole ring is less than a braking
// distance.
//
//   lines -> geometry -> ring -> look-ahead -> run -> segment
//            line_geometry.hpp   line_lookahead.hpp   line_segment.hpp
//            line_chords.hpp             line_profile.hpp
//
// Behind everything handed out stands a stop: the planned speed at the end of the ring is zero,
// and what is handed out can always be followed by braking along the lines in it. Lines that come
// later only make it faster. A segment is a slice of at most `slice_ticks`, and every slice is
// planned from where the last one ended, so an override is in force with the next one: where the
// machine is faster than it may be by then, it brakes as it can. A hold stops on the path, inside a
// line if it comes to that, and resume() goes on from there to the same end.
//
// What next() has made may come too late: the machine has braked, then, from where the last segment
// that came in time ends. Whoever hands segments on takes a mark there, and can return to it:
//
//   mark()  next() next() next()  ...too late, the machine brakes...  return_to(mark, where it
//   stands)
//
// Then the lines are as they were, and the machine goes straight back, as a rapid and dark, to the
// place where it was at the mark, and on from there: nothing of the path is left out, nor is
// anything lit beside it.
//
// Lines end where the program says, to 1/256 step, and not in the middle of steps
// (line_place.hpp): the staircase of steps is within half a step of the line everywhere, and a
// machine at rest between two lines stands inside the nearest step. Only a cancel, and what comes
// too late, go to the middle.
//
// Times: the ticks of segments are what is planned, nothing is rounded behind that; a line takes
// up to two ticks longer than it would without whole ticks (line_profile.hpp).
#pragma once

#include <cstdint>

#include "firmware/motion/line_beam.hpp"
#include "firmware/motion/line_chords.hpp"
#include "firmware/motion/line_lookahead.hpp"
#include "firmware/motion/line_ring.hpp"
#include "firmware/motion/line_segment.hpp"
#include "firmware/motion/line_slice.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// A segment and what the laser does meanwhile. Power changes evenly over lead and tail, 65535 is
/// all; or else the segment shines by itself, in cells.
struct LineSegment {
  stepper::Segment segment;
  std::uint16_t power_start = 0;
  std::uint16_t power_cruise = 0;
  std::uint16_t power_end = 0;
  std::uint32_t line = 0;  ///< that of the target
  bool ends_line = false;  ///< its end is the target
  bool rapid = false;
  /// Of no line: to the middle of a step after cancel() or return_to(), where it may be longer than
  /// a slice, and the way back behind the latter.
  bool settles = false;
};

class LinePlanner {
 public:
  /// The limits stay where they are; `axes` are those that `limits` was made of. The ring is
  /// emptied.
  [[gnu::cold]] LinePlanner(LineRing& ring, const LineLimits& limits, const Limits& axes);

  /// Starts anew from a state at rest, in the middle of its steps. `limits` may have changed.
  void start(const stepper::MotionState& at);

  /// Takes a line; false if the ring is full. One of no length is taken and leaves nothing but its
  /// exact stop.
  bool push(const LineTarget& target);
  /// Makes the next segment; false if there is nothing to do: everything is done, or held and at
  /// rest.
  bool next(LineSegment& out);

  /// A moment to return to.
  struct Mark {
    std::uint32_t begin = 0;    ///< of the ring
    std::uint32_t forgets = 0;  ///< how often all was forgotten before
    LineReal length;            ///< of the first line
    LinePlace place;            ///< where the path goes on
    LineBeam::Place beam;
  };
  Mark mark() const;
  /// The machine stands at `at_rest`, anywhere, and what next() made since the mark was not run.
  /// Nothing was pushed since. All lines are there again, the first one from where it was at
  /// the mark (at the feed that its time asked for, if it is timed); overrides, hold and cancel set
  /// since stay in force. The next segments settle to the middle of the step and go back.
  [[gnu::cold]] void return_to(const Mark& mark, const stepper::MotionState& at_rest);

  /// 10 to 200; acts on what is not handed out. Never above the machine's limits.
  void set_feed_percent(std::uint32_t percent);
  /// 1 to 100.
  void set_rapid_percent(std::uint32_t percent);
  /// Pulses of lines that have them; for lines that have not begun.
  void set_pulses(LineReal per_length) { beam_.set_pulses(per_length); }
  /// Where lists of powers are; before any line has one.
  void set_powers(const stepper::PowerTable* powers) { beam_.set_powers(powers); }
  /// Comes to rest on the path and stays there until resume().
  void hold() { held_ = true; }
  void resume() { held_ = cancelled_; }
  /// Comes to rest and forgets all lines; then it is not held. Nothing may be pushed until idle().
  void cancel() { held_ = cancelled_ = true; }

  /// No motion behind what is handed out, unless next() makes some.
  bool at_rest() const { return is_zero(speed_); }
  /// At rest, and nothing to do.
  bool idle() const { return at_rest() && ring_.empty() && !cancelled_ && !settles_; }
  bool held() const { return held_; }
  std::uint32_t free() const { return LineRing::capacity - ring_.size(); }
  std::uint32_t lines() const { return ring_.size(); }
  /// Where all that was handed out ends.
  const stepper::MotionState& state() const { return at_; }

 private:
  void forget();
  void reset_chords();
  void begin_line();
  LineReal paced_speed(LineReal length);
  LineReal corner_2(const Line& line, const LineShape& shape) const;
  void cap(const LineCap& cap);
  LineTask task();
  LineReal task_speed(const Line& line, const LineTask& task) const;
  void write(const Line& line, const LineTask& task, const LineRun& run, LineSegment& out);
  [[gnu::cold]] void measure_again();
  bool end_cancel(LineSegment& out);
  bool settle(LineSegment& out);
  std::uint32_t settling_ticks() const;
  std::uint16_t power(const Line& line, LineReal speed) const;
  void advance(const LineRun& run);

  LineRing& ring_;
  const LineLimits& limits_;
  const Limits& axes_;
  LineOverride factor_;
  LineLookahead lookahead_;
  bool held_ = false, cancelled_ = false;
  bool settles_ = false;       ///< it has to go to the middle of the step first
  bool returns_ = false;       ///< and then to `back_`: the line under way is the one to there
  std::uint32_t forgets_ = 0;  ///< how often all was forgotten

  // The end of the ring.
  LinePlace end_;
  LineShape last_;     ///< of the last line; no length = none
  bool stop_ = false;  ///< at its end
  LineReal pace_;      ///< paced_speed() of the line before
  LineReal recent_;    ///< mean length of the last lines, times as many
  LineChords short_chords_, long_chords_, gentle_chords_;

  LinePlace back_;  ///< where it left the path

  // The line under way: the first in the ring.
  stepper::MotionState at_;
  LineReal speed_;  ///< along it
  bool begun_ = false;
  bool whole_ = false;  ///< nothing of it is done
  LineWay way_;
  LineReal length_;
  LineBeam beam_;
  int longest_ = 0;
  LineReal time_left_;  ///< ticks at 100 %, if it is timed
};

}  // namespace lamplock::motion
