// Plans a batch of lines of a program.
//
// In:  lines (inbox), commands: overrides, hold, resume, cancel; where to begin again.
// Out: some segments, from the end of the previous batch, and the state of the planner.
// Who: the program runner while the work is at home (work_exchange.hpp); advance(): the main loop
//      or the core that plans, a batch of at most `max_segments` segments and `batch_ticks`, two to
//      five milliseconds on the board. Only the inbox may be filled meanwhile.
//
// A batch covers little time, because planned motion no longer responds to a hold or an override.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/runners/line_buffer.hpp"
#include "firmware/motion/line/planner.hpp"
#include "shared/result.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

/// Commands from the next batch on.
struct LineOrders {
  std::uint32_t feed_percent = 100, rapid_percent = 100;
  std::uint32_t pulses_milli = 0;  ///< per millimetre, of a laser; for lines accepted from now on
  bool held = false;
  bool cancel = false;  ///< stop, drop all lines
  friend bool operator==(const LineOrders& a, const LineOrders& b) {
    return a.feed_percent == b.feed_percent && a.rapid_percent == b.rapid_percent &&
           a.held == b.held && a.cancel == b.cancel;
  }
};

class LineWork {
 public:
  static constexpr std::uint32_t max_segments = 16;
  /// A batch is complete when it lasts at least this long [ticks], or `horizon_ticks` if it begins
  /// at rest. It exceeds that by less than one slice of a line (line/slice.hpp).
  static constexpr std::uint32_t batch_ticks = 4 * (ticks_per_second / 1000);

  // Main loop; only at home, except for the inbox.
  /// A program begins: drops everything. `at`: position at rest. Errors as make_limits(). `powers`
  /// contains the powers of pixels.
  [[gnu::cold]] Result begin(const settings::Values& values, std::uint32_t beat_ticks,
                             std::uint32_t tick_q16, const stepper::MotionState& at,
                             const stepper::PowerTable& powers);
  LineBuffer& inbox() { return inbox_; }
  const LineBuffer& inbox() const { return inbox_; }
  /// The previous batch was not run: the machine has stopped at `at`. Before start().
  [[gnu::cold]] void rejoin(const stepper::MotionState& at);
  /// Begins a batch with these commands.
  void start(const LineOrders& orders);
  /// The batch will be run.
  void accept() { marked_ = false; }
  const motion::Limits& limits() const { return limits_; }

  /// Plans a part; false when the batch is complete.
  bool advance();

  // Results of the batch.
  std::uint32_t count() const { return count_; }
  const motion::LineSegment& segment(std::uint32_t i) const { return made_[i]; }
  /// No line is left; the machine stops with this batch.
  bool drained() const { return planner_.idle() && inbox_.empty(); }
  /// After this batch the machine is at rest.
  bool ends_at_rest() const { return planner_.at_rest(); }
  /// Number of the first line that does not end within this batch, and the step where it ends; 0 =
  /// none is known.
  std::uint32_t first_line(StepPosition& end) const {
    if (ring_.empty() && inbox_.empty()) return 0;
    const motion::Line& line = ring_.at(ring_.begin());
    end = ring_.empty() ? inbox_.front().steps : line.steps;
    return ring_.empty() ? inbox_.front().line : line.line;
  }
  /// Lines known to the planner.
  std::uint32_t lines() const { return planner_.lines(); }

 private:
  void obey();
  void take_lines();

  LineBuffer inbox_;
  motion::Limits limits_;
  motion::LineLimits line_limits_;
  motion::LineRing ring_;
  motion::LinePlanner planner_{ring_, line_limits_, limits_};
  motion::LinePlanner::Mark mark_{};  ///< where the batch begins
  bool marked_ = false;               ///< a batch was not accepted yet
  LineOrders orders_;
  std::uint32_t feed_percent_ = 0, rapid_percent_ = 0;   ///< in force; 0 = not set yet
  std::uint32_t pulses_milli_ = 0, coarsest_milli_ = 1;  ///< per millimetre: pulses, steps
  std::array<motion::LineSegment, max_segments> made_{};
  std::uint32_t count_ = 0;
};

}  // namespace lamplock::machine
