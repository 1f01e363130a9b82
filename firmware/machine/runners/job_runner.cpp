// A job from its points to its plans: outcomes, missed points, the next plan, brake and stop.
#include "firmware/machine/runners/job_runner.hpp"

#include "firmware/motion/profile/pulse.hpp"

namespace lamplock::machine {
namespace {

/// Motion is begun this long after the ticks already handed out.
constexpr std::uint32_t job_start_margin_ticks = 500 * (ticks_per_second / 1'000'000);
/// At rest the host has this long after the last points to complete a window.
constexpr std::uint64_t patience_ticks = 200 * std::uint64_t{ticks_per_second / 1000};
/// As slave a plan is begun when the committed motion lasts for this time more (40 ms): twice the
/// time that planning of a window takes on the board.
constexpr std::uint32_t plan_ahead_ticks = 40 * (ticks_per_second / 1000);
/// It is begun earlier if this many times the longest planning time of the job takes longer.
constexpr std::uint32_t plans_ahead = 2;

}  // namespace

JobRunner::JobRunner(lamp::BeatClock& clock, lamp::ShotScheduler& shots, MotionOutput& output,
                     Planning& planning, HandoutMode parts)
    : clock_(clock),
      shots_(shots),
      parts_(parts),
      output_(output),
      segments_(output.segments()),
      work_exchange_(planning.work_exchange()),
      plan_(planning.window()),
      planning_(planning),
      window_(queue_, shots.beam(), options_, plan_.request()),
      generator_(output.generator()) {}

void JobRunner::begin(const RunOptions& options, const settings::Values& values,
                      std::uint32_t first) {
  clear();
  begun_ = true;
  options_ = options;
  queue_.reset(first);
  recount();
  first_ = received_ = first;
  window_.continue_at({first, 0});
  starvations_ = misses_ = 0;
  slowest_plan_ticks_ = 0;
  job_speed_ = wire::full_job_speed;
  output_.set_lags(values);
  planning_.use_windows(options.mode);
  plan_.begin_job(values, clock_.beat_ticks(), options.min_tick_q16);
  brake_limits_ = plan_.brake_limits();
}

void JobRunner::clear() {
  work_exchange_.recall();
  options_ = RunOptions{};
  queue_.reset(0);
  recount();
  window_.continue_at({});
  from_rest_ = off_target_ = true;
  returning_ = starving_ = braked_ = waiting_for_beam_ = false;
}

bool JobRunner::plan_at_home() const { return work_exchange_.is_owned(); }

void JobRunner::change_beat(const settings::Values& values, std::int32_t min_beats) {
  options_.min_beats = min_beats;
  plan_.begin_job(values, clock_.beat_ticks(), lasting_min_tick_q16());
  brake_limits_ = plan_.brake_limits();
  shots_.cancel_after(0);  // the numbers of beats have changed
  window_.continue_at({queue_.begin(), 0});
  from_rest_ = off_target_ = true;
  returning_ = braked_ = false;
}

std::uint32_t JobRunner::lasting_min_tick_q16() const {
  const std::uint32_t shortest = clock_.min_tick_q16(long_plan_ticks(clock_.beat_ticks()));
  return shortest < full_tick_q16 ? shortest : full_tick_q16;
}

PlanPace JobRunner::plan_pace() const {
  const bool is_slave = clock_.mode() == settings::LampMode::slave;
  const std::uint32_t short_ticks = short_plan_ticks(clock_.beat_ticks());
  // The drift up to the middle of the plan. In its second half the share of the slew limit in the
  // limits covers most of the rest; the lattice may lag the lamp by some microseconds.
  const std::uint32_t min_tick_q16 = clock_.min_tick_q16(plan_ahead_ticks + short_ticks / 2);
  // Axes with different leads are never at rest at the same tick: no other length can begin there.
  return {.wanted = {min_tick_q16, job_speed_},
          .long_tick_q16 = lasting_min_tick_q16(),
          .max_tick_q16 = generator_.lead() == 0 ? clock_.max_tick_q16() : full_tick_q16,
          .short_ticks = is_slave ? short_ticks : 0,
          .long_ticks = is_slave ? long_plan_ticks(clock_.beat_ticks()) : 0,
          .may_cut = !brake_limits_.jerk_limited() && ahead_ticks() <= short_ticks};
}

void JobRunner::read_outcomes() {
  lamp::PointOutcome o;
  bool missed = false;
  while (shots_.outcome(o)) {
    if (o.outcome == lamp::ShotResult::missed) missed = true;
    // Points passed without a shot after a miss are passed again, in order.
    if (missed) continue;
    queue_.mark_done(o.point);
    window_.flash_fired(o.point);
    if (o.point == rest_next_.point && rest_next_.committed != 0) --rest_next_.committed;
  }
  // A point fired after a brake had put it back: its place in the queue may be another's by now.
  if (window_.place().point < queue_.begin()) window_.continue_at({queue_.begin(), 0});
  recount();
  if (missed) {
    ++misses_;
    go_back();
  }
}

void JobRunner::go_back() {
  work_exchange_.recall();
  // The present segment runs to its end; segments that have not begun are removed.
  segments_.clear();
  provisional_ = 0;
  shots_.restart(BeatReason::returning);
  if (generator_.running()) {
    plan_state_ = generator_.segment().end;
    plan_beat_ = clock_.beat_at_or_after(plan_state_.tick);
    shots_.cancel_after(plan_beat_);
  } else {
    plan_state_ = generator_.state();  // axes with a shorter lead may still be moving
  }
  from_rest_ = !generator_.running() || plan_state_.at_rest();
  window_.continue_at({queue_.begin(), 0});
  returning_ = off_target_ = true;
  if (!from_rest_) commit_brake();
}

std::uint32_t JobRunner::first_unfired() {
  lamp::PointOutcome o;
  for (; shots_.untaken(count_.outcomes, o) && o.outcome != lamp::ShotResult::missed;
       ++count_.outcomes) {
    if (o.point != count_.point || ++count_.fired < queue_.left(count_.point)) continue;
    ++count_.point;
    count_.fired = 0;
  }
  return count_.point;
}

std::uint64_t JobRunner::start_beat(std::uint64_t later_ticks) const {
  const std::uint64_t head = generator_.head() + job_start_margin_ticks + later_ticks;
  return clock_.beat_at_or_after(plan_state_.tick > head ? plan_state_.tick : head);
}

bool JobRunner::prepare_start() {
  if (!beam_ready()) return false;
  if (!from_rest_) return true;
  if (!clock_.settled()) return false;
  // Committed motion that ends at rest may still be running.
  if (at_rest()) {
    output_.set_leads(clock_);
    plan_state_ = generator_.state();
  }
  plan_beat_ = start_beat(0);
  plan_state_.tick = clock_.tick_of_beat(plan_beat_);
  for (stepper::AxisState& axis : plan_state_.axis) axis.speed_q62 = 0;
  return true;
}

void JobRunner::look_ahead() {
  // The request of a recalled plan belongs to the planner until the end of its slice.
  if (braked_ || !work_exchange_.is_owned()) return;
  window_.fill_request({from_rest_, off_target_, job_speed_ < wire::full_job_speed});
}

bool JobRunner::beam_ready() {
  const lamp::Beam* first = window_.first_beam();
  if (first == nullptr || shots_.beam().is_ready_for(*first)) return true;
  // Shots handed out use the beam as it is. It is never changed in motion: the provisional brake
  // stops the machine.
  const bool ready = from_rest_ && !shots_.point_pending() && shots_.beam().prepare(*first);
  waiting_for_beam_ = !ready;
  return ready;
}

bool JobRunner::may_plan() {
  if (received_ != queue_.end()) {
    received_ = queue_.end();
    receive_tick_ = generator_.head();
  }
  look_ahead();
  if (window_.ready()) {
    starving_ = false;
    return true;
  }
  const std::uint32_t next = window_.place().point;
  if (next == options_.points_total || !at_rest()) return false;
  // At rest the host has some time to complete a window; at the start of a job it is late only
  // after that.
  const bool patient = generator_.head() < receive_tick_ + patience_ticks;
  if (next == first_ && patient) return false;
  if (!starving_ && next != first_) ++starvations_;
  starving_ = true;
  return !window_.empty() && !patient;
}

std::uint32_t JobRunner::ahead_ticks() const {
  const std::uint32_t plans = plans_ahead * slowest_plan_ticks_;
  return plans > plan_ahead_ticks ? plans : plan_ahead_ticks;
}

bool JobRunner::plan_is_due() const {
  return clock_.mode() != settings::LampMode::slave || at_rest() ||
         plan_state_.tick <= generator_.head() + ahead_ticks();
}

bool JobRunner::prepare(bool go) {
  waiting_for_beam_ = false;
  // In this order: an edge may occur in between.
  if (!shots_.point_pending()) braked_ = false;
  read_outcomes();
  if (provisional_begun()) keep_provisional();
  if (!go || braked_)
    work_exchange_.recall();
  else if (planning_.may_hand_out())
    begin_plan();
  window_.forget();  // more points will be known
  const PlanStands state = plan_stands();
  return state != PlanStands::none && state != PlanStands::full;
}

void JobRunner::begin_plan() {
  if (!may_plan() || !plan_is_due() || !prepare_start()) return;
  motion::PlanRequest& request = plan_.request();
  request.queue = &queue_;
  request.mode = options_.mode;
  request.min_beats = options_.min_beats;
  request.start = plan_state_;
  request.follows = !off_target_;
  plan_.start(plan_pace());
  asked_tick_ = generator_.tick();
  handed_ = staged_ = 0;
  work_exchange_.hand_out();
}

/// Brakes the present motion. Where jerk is limited a brake can go further than the plan; if it
/// would leave the work space, the present segment runs to its end, from where a brake stays
/// inside. Returns the state at rest.
stepper::MotionState JobRunner::brake_from(const stepper::MotionState& head) {
  stepper::Segment s = motion::make_brake(head, brake_limits_, generator_.accelerations_q62());
  if (!brake_limits_.jerk_limited() || motion::stays_inside(s, head, brake_limits_)) {
    generator_.replace(s);
    return s.end;
  }
  generator_.take_back_shot();
  const stepper::MotionState& end = generator_.segment().end;
  if (end.at_rest()) return end;
  s = motion::make_brake(end, brake_limits_);
  segments_.push(s);
  return s.end;
}

void JobRunner::brake() {
  work_exchange_.recall();
  segments_.clear();
  provisional_ = 0;
  const stepper::MotionState head = generator_.state();
  clock_.keep_tick_length(head.tick);
  // Shots before the head are with the board and are judged by its edges.
  shots_.cancel_after(clock_.beat_at_or_after(head.tick + 1) - 1);
  // Also where the speed is zero for a moment, at the start of a segment or at a reversal.
  plan_state_ = head;
  if (generator_.running()) {
    plan_state_ = brake_from(head);
    clock_.set_motion_end(plan_state_.tick);
  }
  window_.continue_at({queue_.begin(), 0});
  from_rest_ = off_target_ = true;
  returning_ = false;
  braked_ = true;
}

void JobRunner::halt() {
  work_exchange_.recall();
  generator_.halt();
  provisional_ = 0;
  shots_.cancel_after(0);
  clock_.set_motion_end(0);
  window_.continue_at({queue_.begin(), 0});
  from_rest_ = off_target_ = true;
}

}  // namespace lamplock::machine
