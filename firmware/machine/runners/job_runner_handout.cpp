// Hands out the plan of a job, in parts; each part ends with a provisional brake.
#include "firmware/machine/runners/job_runner.hpp"
#include "firmware/motion/profile/pulse.hpp"

namespace lamplock::machine {
namespace {

/// A plan is slow if it takes more than half of the duration of its motion: the next one may take
/// twice as long.
constexpr std::uint64_t slow_plan_divisor = 2;

}  // namespace

bool JobRunner::starts_late() const {
  const motion::PlanRequest& request = plan_.request();
  if (!at_rest() || request.count != window_points) return false;
  return plan_ticks_ * slow_plan_divisor > plan_.planned_ticks();
}

/// Segments of the plan that can be handed out now. Planning is ahead of the queues.
std::uint32_t JobRunner::part() const {
  const std::uint32_t left = plan_.count() - handed_;
  const std::uint32_t next = left < part_segments ? left : part_segments;
  const std::uint32_t free = segments_.free() + provisional_;
  const std::uint32_t room = free < shots_.free() ? free : shots_.free();
  return room > next ? next : 0;  // a brake follows them
}

JobRunner::PlanStands JobRunner::plan_stands() const {
  if (!work_exchange_.asked()) return PlanStands::none;
  if (!work_exchange_.complete()) return PlanStands::at_work;
  if (!plan_.found()) return PlanStands::no_way;
  return part() == 0 ? PlanStands::full : PlanStands::part;
}

Committed JobRunner::commit() {
  switch (plan_stands()) {
    case PlanStands::part:
      // Completed after stage(): hand it out next time.
      if (parts_ == HandoutMode::staged && staged_ == 0) return Committed::nothing;
      // Planning took too long, and its start has passed.
      if (provisional_begun())
        keep_provisional();
      else
        commit_plan();
      return Committed::part;
    case PlanStands::no_way:
      if (provisional_ != 0) {  // no way from there, but perhaps from rest
        keep_provisional();
        return Committed::nothing;
      }
      failed_point_ = plan_.request().points[plan_.failed()];
      work_exchange_.recall();
      return Committed::no_way;
    default:
      return Committed::nothing;
  }
}

void JobRunner::take_back_provisional() {
  segments_.take_back(provisional_);
  shots_.cancel_after(plan_beat_);
  provisional_ = 0;
}

void JobRunner::keep_provisional() {
  work_exchange_.recall();
  staged_ = 0;
  provisional_ = 0;
  plan_state_ = rest_state_;
  from_rest_ = true;
  window_.continue_at(rest_next_);
  if (returning_) return;
  ++starvations_;
  starving_ = true;
}

void JobRunner::time_plan() {
  plan_ticks_ = generator_.tick() - asked_tick_;
  if (plan_ticks_ > slowest_plan_ticks_)
    slowest_plan_ticks_ = static_cast<std::uint32_t>(plan_ticks_);
}

void JobRunner::start_later() {
  if (!from_rest_) return;
  const std::uint64_t beat = start_beat(handed_ == 0 && starts_late() ? plan_ticks_ : 0);
  if (beat == plan_beat_) return;
  plan_beat_ = beat;
  plan_state_.tick = clock_.tick_of_beat(beat);
}

void JobRunner::commit_plan() {
  const std::uint32_t first = handed_, end = handed_ + (staged_ != 0 ? staged_ : part());
  brake_limits_ = plan_.brake_limits();
  if (first == 0) time_plan();
  take_back_provisional();
  const std::uint64_t staged_tick = plan_state_.tick;
  start_later();
  if (plan_state_.tick != staged_tick) staged_ = 0;  // will be staged again
  clock_.set_min_tick(plan_state_.tick, plan_.min_tick_q16());
  clock_.set_tick_length(plan_state_.tick, plan_.tick_length_q16());
  const std::uint64_t late_ticks = plan_state_.tick - plan_.segment(first).start_tick;
  for (std::uint32_t i = first; i < end; ++i) push(i, late_ticks, plan_beat_);
  plan_state_ = plan_.segment(end - 1).end;
  plan_state_.tick += late_ticks;
  window_.continue_at(window_.place_after(first, end));
  returning_ = off_target_ = false;
  from_rest_ = plan_state_.at_rest();
  rest_state_ = plan_state_;
  rest_next_ = window_.place();
  clock_.set_motion_end(rest_state_.tick);
  clock_.set_tick_length(rest_state_.tick, full_tick_q16);
  if (!from_rest_) commit_brake();
  staged_ = 0;
  handed_ = end;
  if (handed_ == plan_.count()) work_exchange_.recall();
}

void JobRunner::write_segment(std::uint32_t i, std::uint64_t late_ticks,
                              stepper::Segment& segment) const {
  segment = plan_.segment(i);
  segment.start_tick += late_ticks;
  segment.end.tick += late_ticks;
  segment.reason = returning_ && i == 0 ? BeatReason::returning
                   : options_.dry       ? BeatReason::dry
                                        : BeatReason::moving;
  if (window_.gone_to() && i == 0) segment.ends_point = false;
  if (options_.dry) segment.shot.present = false;
}

void JobRunner::stage() {
  if (staged_ != 0 || !part_waits()) return;
  staged_ = part();
  // Later parts of a plan are as late as its first part.
  const std::uint64_t late_ticks = plan_state_.tick - plan_.segment(handed_).start_tick;
  // The first one may replace a brake, which may still begin.
  for (std::uint32_t i = 1; i < staged_; ++i)
    write_segment(handed_ + i, late_ticks, segments_.stage(i - provisional_));
  stepper::MotionState end = plan_.segment(handed_ + staged_ - 1).end;
  end.tick += late_ticks;
  segments_.stage(staged_ - provisional_) = motion::make_brake(end, plan_.brake_limits());
}

void JobRunner::push(std::uint32_t i, std::uint64_t late_ticks, std::uint64_t& beat) {
  if (staged_ == 0 || i == handed_) write_segment(i, late_ticks, segments_.stage());
  const auto beats = static_cast<std::uint64_t>(plan_.beats(i));
  shots_.commit(segments_.stage(), beat + 1, beat + beats);
  segments_.publish();
  beat += beats;
}

void JobRunner::commit_brake() {
  clock_.keep_tick_length(plan_state_.tick);
  stepper::Segment& s = segments_.stage();
  if (staged_ == 0) s = motion::make_brake(plan_state_, brake_limits_);
  segments_.publish();
  provisional_ = 1;
  rest_state_ = s.end;
  rest_next_ = window_.place();
  clock_.set_motion_end(s.end.tick);
}

}  // namespace lamplock::machine
