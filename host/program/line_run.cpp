#include "host/program/line_run.hpp"

#include <algorithm>
#include <utility>

#include "firmware/machine/runners/program_horizon.hpp"
#include "host/job/rate_excess.hpp"

namespace lamplock::program_run {
namespace {

/// Limits are those of ticks of nominal length; the beat does not matter for them.
constexpr std::uint32_t some_beat_ticks = ticks_per_second / 100;
/// A board that accepts the full rate of the cable, USB at full speed: 19 packets of 64 bytes in a
/// millisecond, read four times in it; and the ticks that it has filled.
constexpr std::uint64_t round_ticks = ticks_per_second / 4000;
constexpr std::size_t bytes_per_round = 19 * 64 / 4;
constexpr std::uint64_t filled_ticks = 9 * round_ticks;
constexpr std::uint32_t us_per_tick = 1'000'000 / ticks_per_second;

Error no_motion(const settings::Values& values) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  motion::make_limits(values, some_beat_ticks, full_tick_q16, limits, setting);
  return job::no_motion(values, setting);
}

}  // namespace

LineRun::LineRun(const settings::Values& values) {
  stepper::MotionState rest;
  for (stepper::AxisState& axis : rest.axis) axis.position_q64 = stepper::middle_of_step(0);
  if (work_->begin(values, some_beat_ticks, full_tick_q16, rest, no_powers_) != Result::ok)
    throw no_motion(values);
}

void LineRun::receive(std::size_t bytes) {
  bytes_ += bytes;
  for (; bytes_ > bytes_per_round; bytes_ -= bytes_per_round) round();
}

void LineRun::take(const motion::LineTarget& line) {
  while (work_->inbox().full()) round();
  work_->inbox().push(line);
  last_line_ = std::max(last_line_, line.line);
}

void LineRun::finish() {
  while (!work_->drained() || now_ < end_) round();
}

void LineRun::dwell(std::uint32_t us) {
  finish();
  now_ += us / us_per_tick;
  dwelt_ticks_ += us / us_per_tick;
}

void LineRun::change_speed(std::vector<SpeedChange> changes) {
  changes_begin_ = ticks_ + dwelt_ticks_;
  changes_ = std::move(changes);
}

/// The last change that is due.
machine::LineOrders LineRun::orders() const {
  machine::LineOrders orders;
  const double now_s =
      static_cast<double>(ticks_ + dwelt_ticks_ - changes_begin_) / ticks_per_second;
  for (const SpeedChange& change : changes_) {
    if (change.at_s > now_s) break;
    orders.feed_percent = change.feed_percent;
    orders.rapid_percent = change.rapid_percent;
  }
  return orders;
}

void LineRun::note_ends() {
  StepPosition end{};
  const std::uint32_t first = work_->first_line(end);
  line_ends_.resize(std::max<std::size_t>(line_ends_.size(), first == 0 ? last_line_ : first - 1),
                    ticks_);
}

/// One round of the main loop: see ProgramRunner::wants_batch() and start_tick().
void LineRun::round() {
  now_ += round_ticks;
  const std::uint64_t head = now_ + filled_ticks;
  if (work_->drained() || end_ >= head + machine::horizon_ticks) return;
  if (work_->ends_at_rest()) end_ = std::max(end_, head + machine::start_margin_ticks);
  work_->start(orders());
  while (work_->advance()) {
  }
  for (std::uint32_t i = 0; i < work_->count(); ++i) {
    ticks_ += work_->segment(i).segment.ticks;
    end_ += work_->segment(i).segment.ticks;
  }
  work_->accept();
  note_ends();
}

}  // namespace lamplock::program_run
