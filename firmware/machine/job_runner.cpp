#include "firmware/machine/job_runner.hpp"

#include "firmware/motion/profile.hpp"

namespace lamplock::machine {
namespace {

/// Motion is begun this long after the ticks already handed out.
constexpr std::uint32_t start_margin_ticks = 500 * (ticks_per_second / 1'000'000);
/// At rest the host has this long, after the last points, to complete a window.
constexpr std::uint64_t patience_ticks = 200 * std::uint64_t{ticks_per_second / 1000};
/// Limits are made anew when the shortest tick has moved by more than this: 1/512.
constexpr std::uint32_t limits_step_q16 = full_tick_q16 / 512;

}  // namespace

void JobRunner::begin(const RunOptions& options, const settings::Values& values,
                      std::uint32_t first) {
  clear();
  options_ = options;
  queue_.reset(first);
  next_ = first_ = received_ = first;
  starvations_ = misses_ = 0;
  make_limits(values, options.shortest_tick_q16, limits_);
}

void JobRunner::clear() {
  options_ = RunOptions{};
  queue_.reset(0);
  next_ = 0;
  from_rest_ = true;
  returning_ = starving_ = braked_ = false;
}

std::uint32_t JobRunner::shortest_tick_q16() const {
  // Rounded down to a coarse grid, so that a steady lamp gives the same plan every time.
  const std::uint32_t shortest = clock_.shortest_tick_q16();
  return shortest - shortest % limits_step_q16;
}

void JobRunner::make_limits(const settings::Values& values, std::uint32_t tick_q16,
                            motion::Limits& limits) {
  // The settings were checked when the job began; a shorter tick only makes limits smaller.
  std::uint16_t setting = 0;
  motion::make_limits(values, clock_.beat_ticks(), tick_q16, limits, setting);
  limits_tick_q16_ = tick_q16;
}

void JobRunner::read_outcomes() {
  lamp::PointOutcome o;
  bool missed = false;
  while (shots_.outcome(o)) {
    if (o.outcome == lamp::Outcome::missed)
      missed = true;
    else if (o.point >= queue_.begin() && o.point < queue_.end())
      queue_.mark_done(o.point);
  }
  // A point fired after a brake had put it back: its place in the queue may be another's by now.
  if (next_ < queue_.begin()) next_ = queue_.begin();
  if (missed) {
    ++misses_;
    go_back();
  }
}

void JobRunner::go_back() {
  // What is being run is carried to its end; what has not begun is taken back.
  segments_.clear();
  provisional_ = 0;
  shots_.restart(BeatReason::returning);
  if (generator_.running()) {
    plan_state_ = generator_.segment().end;
    plan_beat_ = clock_.beat_at_or_after(plan_state_.tick);
    shots_.cancel_after(plan_beat_);
  }
  from_rest_ = !generator_.running() || plan_state_.at_rest();
  next_ = queue_.begin();
  returning_ = true;
  if (!from_rest_) commit_brake();
}

std::uint64_t JobRunner::start_beat() const {
  const std::uint64_t head = generator_.state().tick + start_margin_ticks;
  return clock_.beat_at_or_after(plan_state_.tick > head ? plan_state_.tick : head);
}

bool JobRunner::prepare_start() {
  if (!from_rest_) return true;
  if (!clock_.settled()) return false;
  // Motion that is committed and ends at rest may still be running.
  if (at_rest()) plan_state_ = generator_.state();
  plan_beat_ = start_beat();
  plan_state_.tick = clock_.tick_of_beat(plan_beat_);
  for (stepper::AxisState& axis : plan_state_.axis) axis.speed_q62 = 0;
  return true;
}

bool JobRunner::window_ready() {
  request_.count = 0;
  for (std::uint32_t i = next_; i != queue_.end() && request_.count < motion::window_points; ++i)
    if (!queue_.done(i)) request_.points[request_.count++] = i;
  const bool all_known = queue_.end() == options_.points_total;
  const std::uint32_t behind = request_.count == 0 ? 0 : request_.points[request_.count - 1] + 1;
  request_.rest_at_end = !all_known || behind == queue_.end();
  if (request_.count == motion::window_points) {
    request_.rest_at_end = all_known && behind == queue_.end();
    return true;
  }
  return request_.count != 0 && all_known;
}

bool JobRunner::may_plan() {
  const std::uint32_t room = motion::commit_points + 1 - provisional_;
  if (segments_.free() < room || shots_.free() < room) return false;
  if (received_ != queue_.end()) {
    received_ = queue_.end();
    receive_tick_ = generator_.state().tick;
  }
  if (window_ready()) {
    starving_ = false;
    return true;
  }
  if (next_ == options_.points_total || !from_rest_) return false;
  // At rest the host has some time to complete a window; at the very start it is only late then.
  const bool patient = generator_.state().tick < receive_tick_ + patience_ticks;
  if (at_rest() && next_ == first_ && patient) return false;
  if (!starving_ && next_ != first_) ++starvations_;
  starving_ = true;
  return request_.count != 0 && !patient;
}

bool JobRunner::prepare(bool go) {
  // In this order: an edge may come in between.
  if (!shots_.shot_pending()) braked_ = false;
  read_outcomes();
  if (provisional_begun()) keep_provisional();
  if (!go || braked_ || !may_plan() || !prepare_start()) return false;
  request_.queue = &queue_;
  request_.mode = options_.mode;
  request_.least_beats = options_.least_beats;
  request_.start = plan_state_;
  shortest_tick_q16_ = shortest_tick_q16();
  return true;
}

void JobRunner::plan(const settings::Values& values) {
  planned_ = shortest_tick_q16_ != limits_tick_q16_ && plan_with_new_limits(values);
  if (planned_) return;
  request_.limits = &limits_;
  planned_ = planner_.plan(request_, failed_) == Result::ok;
}

bool JobRunner::plan_with_new_limits(const settings::Values& values) {
  // The lamp has become faster or slower. Speeds planned under the old limits may not fit into
  // new, smaller ones at once: then the old ones serve once more.
  const std::uint32_t old_tick_q16 = limits_tick_q16_;
  make_limits(values, shortest_tick_q16_, new_limits_);
  request_.limits = &new_limits_;
  if (planner_.plan(request_, failed_) == Result::ok) {
    limits_ = new_limits_;
    return true;
  }
  limits_tick_q16_ = old_tick_q16;
  return false;
}

Result JobRunner::commit() {
  // Planning took too long and what it started from has passed, or there is no way on from there.
  if (provisional_begun() || (!planned_ && provisional_ != 0)) {
    keep_provisional();
  } else if (planned_) {
    commit_plan();
  } else {
    failed_point_ = request_.points[failed_];
    return Result::unreachable;
  }
  return Result::ok;
}

void JobRunner::take_back_provisional() {
  segments_.take_back(provisional_);
  shots_.cancel_after(plan_beat_);
  provisional_ = 0;
}

void JobRunner::keep_provisional() {
  provisional_ = 0;
  plan_state_ = rest_state_;
  from_rest_ = true;
  next_ = rest_next_;
  if (returning_) return;
  ++starvations_;
  starving_ = true;
}

void JobRunner::start_later() {
  const std::uint64_t beat = start_beat();
  if (!from_rest_ || beat == plan_beat_) return;
  plan_beat_ = beat;
  plan_state_.tick = clock_.tick_of_beat(beat);
}

void JobRunner::commit_plan() {
  const std::uint32_t count = request_.commits();
  take_back_provisional();
  start_later();
  const std::uint64_t late_ticks = plan_state_.tick - request_.start.tick;
  for (std::uint32_t i = 0; i < count; ++i) push(i, late_ticks, plan_beat_);
  plan_state_ = planner_.segment(count - 1).end;
  plan_state_.tick += late_ticks;
  next_ = request_.points[count - 1] + 1;
  returning_ = false;
  from_rest_ = plan_state_.at_rest();
  rest_state_ = plan_state_;
  rest_next_ = next_;
  clock_.set_motion_end(rest_state_.tick);
  if (!from_rest_) commit_brake();
}

void JobRunner::push(std::uint32_t i, std::uint64_t late_ticks, std::uint64_t& beat) {
  stepper::Segment segment = planner_.segment(i);
  segment.start_tick += late_ticks;
  segment.end.tick += late_ticks;
  segment.reason = returning_ && i == 0 ? BeatReason::returning
                   : options_.dry       ? BeatReason::dry
                                        : BeatReason::moving;
  if (options_.dry) segment.shot.present = false;
  const auto beats = static_cast<std::uint64_t>(planner_.beats(i));
  shots_.commit(segment, beat + 1, beat + beats);
  segments_.push(segment);
  beat += beats;
}

void JobRunner::commit_brake() {
  const stepper::Segment s = motion::make_brake(plan_state_, limits_);
  segments_.push(s);
  provisional_ = 1;
  rest_state_ = s.end;
  rest_next_ = next_;
  clock_.set_motion_end(s.end.tick);
}

void JobRunner::brake() {
  segments_.clear();
  provisional_ = 0;
  const stepper::MotionState head = generator_.state();
  // What lies before the head has been handed to the board and is judged by its edges.
  shots_.cancel_after(clock_.beat_at_or_after(head.tick + 1) - 1);
  // Also where the speed is zero for a moment, at the start of a segment or at a turn.
  if (generator_.running()) {
    const stepper::Segment s = motion::make_brake(head, limits_);
    generator_.replace(s);
    plan_state_ = s.end;
    clock_.set_motion_end(plan_state_.tick);
  }
  next_ = queue_.begin();
  from_rest_ = true;
  returning_ = false;
  braked_ = true;
}

void JobRunner::halt() {
  generator_.halt();
  segments_.clear();
  provisional_ = 0;
  shots_.cancel_after(0);
  clock_.set_motion_end(0);
  next_ = queue_.begin();
  from_rest_ = true;
}

}  // namespace lamplock::machine
