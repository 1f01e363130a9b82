#include "firmware/machine/runners/line_work.hpp"

#include "firmware/machine/runners/program_horizon.hpp"

namespace lamplock::machine {
namespace {

/// Lines taken for a batch: more than it uses, so that look-ahead fills up, also where a batch has
/// three or four segments of 16 joined lines each. The inbox is filled meanwhile. A line that is
/// not joined takes the chip two to three times as long: with more of them a batch would be late.
constexpr std::uint32_t max_queued_lines = 5 * LineWork::max_segments;
constexpr std::uint32_t max_unjoined_lines = 2 * LineWork::max_segments;

constexpr std::uint32_t nm_per_milli_mm = 1000;
/// Minimum average duration of a line where very many are very short: at 125 MHz reading one takes
/// some 100 us of the chip, handing out its segments and filling their ticks 90 us more, which
/// lines that are joined share (docs/testing.md).
constexpr std::uint32_t min_joined_line_ticks = clock_hz == 200'000'000 ? 62 : 98;
constexpr std::uint32_t min_line_ticks = clock_hz == 200'000'000 ? 128 : 195;

}  // namespace

Result LineWork::begin(const settings::Values& values, std::uint32_t beat_ticks,
                       std::uint32_t tick_q16, const stepper::MotionState& at,
                       const stepper::PowerTable& powers) {
  std::uint16_t setting = 0;
  const Result result = motion::make_limits(values, beat_ticks, tick_q16, limits_, setting);
  if (result != Result::ok) return result;
  std::int32_t coarsest = values.milli(settings::Id::steps_per_mm_x);
  for (int a = 1; a < limits_.axes; ++a) {
    const std::int32_t milli = values.milli(settings::Id::steps_per_mm_x, a);
    if (milli < coarsest) coarsest = milli;
  }
  const auto deviation =
      static_cast<std::uint32_t>(values.milli(settings::Id::junction_deviation)) * nm_per_milli_mm;
  line_limits_ = motion::make_line_limits(limits_, coarsest, deviation);
  line_limits_.joined_line_ticks = min_joined_line_ticks;
  line_limits_.line_ticks = min_line_ticks;
  coarsest_milli_ = static_cast<std::uint32_t>(coarsest);
  inbox_.clear();
  planner_.set_powers(&powers);
  planner_.start(at);
  start({});
  marked_ = false;
  feed_percent_ = rapid_percent_ = pulses_milli_ = 0;
  return Result::ok;
}

void LineWork::rejoin(const stepper::MotionState& at) {
  // The previous batch may not have begun.
  planner_.return_to(marked_ ? mark_ : planner_.mark(), at);
}

void LineWork::start(const LineOrders& orders) {
  orders_ = orders;
  count_ = 0;
}

void LineWork::obey() {
  // Only changes: each makes the planner review all of its lines.
  if (orders_.feed_percent != feed_percent_) planner_.set_feed_percent(orders_.feed_percent);
  if (orders_.rapid_percent != rapid_percent_) planner_.set_rapid_percent(orders_.rapid_percent);
  feed_percent_ = orders_.feed_percent;
  rapid_percent_ = orders_.rapid_percent;
  // A length is in steps of the coarsest axis.
  if (orders_.pulses_milli != pulses_milli_)
    planner_.set_pulses(motion::UFloat(orders_.pulses_milli) / motion::UFloat(coarsest_milli_));
  pulses_milli_ = orders_.pulses_milli;
  if (orders_.cancel) {
    planner_.cancel();
    inbox_.clear();
  } else if (orders_.held) {
    planner_.hold();
  } else {
    planner_.resume();
  }
}

void LineWork::take_lines() {
  const std::uint32_t lines = planner_.lines();
  for (std::uint32_t i = 0; i < max_queued_lines && planner_.free() != 0 && !inbox_.empty(); ++i) {
    if (planner_.lines() - lines == max_unjoined_lines) return;
    planner_.push(inbox_.front());
    inbox_.pop();
  }
}

bool LineWork::advance() {
  obey();
  if (!orders_.cancel) take_lines();
  mark_ = planner_.mark();
  marked_ = true;
  // A start from rest has no motion ahead, and too little ahead slows the machine down.
  const std::uint64_t wanted_ticks = planner_.at_rest() ? horizon_ticks : batch_ticks;
  std::uint64_t ticks = 0;
  while (count_ < max_segments && ticks < wanted_ticks) {
    motion::LineSegment& made = made_[count_];
    if (!planner_.next(made)) break;
    ticks += made.segment.ticks;
    ++count_;
  }
  return false;
}

}  // namespace lamplock::machine
