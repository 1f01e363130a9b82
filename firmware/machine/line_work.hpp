// A batch of lines of a program, planned by whoever plans.
//
// In:  lines (inbox), orders: overrides, hold, resume, cancel; where to begin anew.
// Out: some segments, from where the batch before ended, and how the planner stands.
// Called by the program runner while it is at home (hand_over.hpp), advance() by the main loop or
// the core that plans: a batch of at most `most_segments` segments and `batch_ticks`, two to five
// milliseconds on the board. The inbox alone may be filled meanwhile.
//
// A batch covers little time, for what is planned does not follow a hold or an override any more.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/line_inbox.hpp"
#include "firmware/motion/line_planner.hpp"
#include "shared/result.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

/// What is wanted from the next batch on.
struct LineOrders {
  std::uint32_t feed_percent = 100, rapid_percent = 100;
  std::uint32_t pulses_milli = 0;  ///< a millimetre, of a laser's; for lines taken from now on
  bool held = false;
  bool cancel = false;  ///< come to rest, forget all lines
  friend bool operator==(const LineOrders& a, const LineOrders& b) {
    return a.feed_percent == b.feed_percent && a.rapid_percent == b.rapid_percent &&
           a.held == b.held && a.cancel == b.cancel;
  }
};

class LineWork {
 public:
  static constexpr std::uint32_t most_segments = 16;
  /// A batch is complete when it lasts at least this long [ticks], or `horizon_ticks` if it begins
  /// at rest. It exceeds that by less than one slice of a line (line_slice.hpp).
  static constexpr std::uint32_t batch_ticks = 4 * (ticks_per_second / 1000);

  // The main loop's; at home, but for the inbox.
  /// A program begins: forgets everything. `at`: where the machine stands. Errors as make_limits().
  /// Powers of pixels lie in `powers`.
  [[gnu::cold]] Result begin(const settings::Values& values, std::uint32_t beat_ticks,
                             std::uint32_t tick_q16, const stepper::MotionState& at,
                             const stepper::PowerTable& powers);
  LineInbox& inbox() { return inbox_; }
  const LineInbox& inbox() const { return inbox_; }
  /// The batch before was not run: the machine has come to rest at `at`. Before start().
  [[gnu::cold]] void rejoin(const stepper::MotionState& at);
  /// A new batch, with these orders.
  void start(const LineOrders& orders);
  /// What came of the batch will be run.
  void accept() { marked_ = false; }
  const motion::Limits& limits() const { return limits_; }

  /// Goes on; false when the batch is complete.
  bool advance();

  // What came of it.
  std::uint32_t count() const { return count_; }
  const motion::LineSegment& segment(std::uint32_t i) const { return made_[i]; }
  /// Nothing is left of what was known; the machine comes to rest with this batch.
  bool drained() const { return planner_.idle() && inbox_.empty(); }
  /// Behind this batch the machine is at rest.
  bool ends_at_rest() const { return planner_.at_rest(); }
  /// Number of the first line that does not end before this batch does, and the step where it ends;
  /// 0 = none is known.
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

  LineInbox inbox_;
  motion::Limits limits_;
  motion::LineLimits line_limits_;
  motion::LineRing ring_;
  motion::LinePlanner planner_{ring_, line_limits_, limits_};
  motion::LinePlanner::Mark mark_{};  ///< where the batch begins
  bool marked_ = false;               ///< there is one that was not accepted
  LineOrders orders_;
  std::uint32_t feed_percent_ = 0, rapid_percent_ = 0;   ///< in force; 0 = not set yet
  std::uint32_t pulses_milli_ = 0, coarsest_milli_ = 1;  ///< a millimetre: pulses, steps
  std::array<motion::LineSegment, most_segments> made_{};
  std::uint32_t count_ = 0;
};

}  // namespace lamplock::machine
