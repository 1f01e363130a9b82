#include "firmware/machine/runners/window_plan.hpp"

#include <algorithm>
#include <limits>

namespace lamplock::machine {
namespace {

/// A percentage of a value in thousandths.
std::int32_t scaled(std::int32_t milli, std::uint32_t percent) {
  const std::int64_t wide = std::int64_t{milli} * percent / wire::full_job_speed;
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(wide < most ? wide : most);
}

}  // namespace

settings::Values at_job_speed(const settings::Values& job, const settings::Values& own,
                              std::uint32_t percent) {
  settings::Values values = job;
  if (percent == wire::full_job_speed) return values;
  const auto scale = [&](settings::Id id, std::int32_t milli, std::int32_t least) {
    const std::int32_t most = own.milli(id);
    values.put_milli(id, milli < least ? least : milli < most ? milli : most);
  };
  constexpr std::int32_t min_rate = settings::range(settings::Id::max_rate_x).min_milli;
  constexpr std::int32_t min_accel = settings::range(settings::Id::acceleration_x).min_milli;
  for (int axis = 0; axis < max_axes; ++axis) {
    const settings::Id rate = settings::for_axis(settings::Id::max_rate_x, axis);
    const settings::Id accel = settings::for_axis(settings::Id::acceleration_x, axis);
    scale(rate, scaled(job.milli(rate), percent), min_rate);
    scale(accel, scaled(scaled(job.milli(accel), percent), percent), min_accel);
    const settings::Id jerk = settings::for_axis(settings::Id::jerk_x, axis);
    if (job.milli(jerk) == 0) continue;  // not limited
    std::int32_t third = job.milli(jerk);
    for (int power = 0; power < 3; ++power) third = scaled(third, percent);
    const std::int32_t most = own.milli(jerk);
    if (most != 0 && third > most) third = most;
    values.put_milli(jerk, third < 1 ? 1 : third);
  }
  return values;
}

void WindowPlan::begin_job(const settings::Values& values, std::uint32_t beat_ticks,
                           std::uint32_t tick_q16) {
  beat_ticks_ = beat_ticks;
  fastest_ = wire::full_job_speed;
  pace_ = {tick_q16, wire::full_job_speed};
  is_long_ = false;
  make_limits(values, values, pace_, limits_);
  brake_limits_ = limits_;
  brake_pace_ = pace_;
}

bool WindowPlan::make_limits(const settings::Values& values, const settings::Values& own,
                             const Pace& pace, motion::Limits& limits) const {
  // The settings were checked when the job began; only the lowest job speeds can be too low for
  // the planner.
  std::uint16_t setting = 0;
  return motion::make_limits(at_job_speed(values, own, pace.job_speed), beat_ticks_, pace.tick_q16,
                             limits, setting) == Result::ok;
}

void WindowPlan::start(const PlanPace& pace) {
  conditions_ = pace;
  if (is_long_) conditions_.wanted.tick_q16 = pace.long_tick_q16;
  trying_ = conditions_.wanted;
  tick_length_q16_ = full_tick_q16;
  attempt_ = Attempt::wanted;
  step_ = Step::ready;
}

bool WindowPlan::advance(const settings::Values& values, const settings::Values& own) {
  switch (step_) {
    case Step::ready:
      if (begin_attempt(values, own))
        step_ = Step::planning;
      else
        end_attempt(false);
      break;
    case Step::planning:
      if (!planner_.advance()) end_attempt(planner_.result() == Result::ok);
      break;
    default:
      break;
  }
  return step_ == Step::ready || step_ == Step::planning;
}

bool WindowPlan::begin_attempt(const settings::Values& values, const settings::Values& own) {
  request_.limits = attempt_limits(values, own);
  if (request_.limits == nullptr) return false;
  planner_.begin(request_);
  return true;
}

/// Limits of the present attempt; null if they cannot be made.
const motion::Limits* WindowPlan::attempt_limits(const settings::Values& values,
                                                 const settings::Values& own) {
  Pace pace = attempt_ == Attempt::wanted ? trying_ : pace_;
  if (attempt_ == Attempt::longer) {
    pace.tick_q16 = longer_tick_q16();
    if (pace.tick_q16 == full_tick_q16) return &limits_;
  } else {
    if (pace.job_speed > fastest_) fastest_ = pace.job_speed;
    set_brake_limits(values, own, pace.tick_q16);
    if (pace == pace_) return &limits_;
  }
  return make_limits(values, own, pace, new_limits_) ? &new_limits_ : nullptr;
}

/// Makes the limits of a brake: for the ticks of the plan, at the fastest job speed so far.
void WindowPlan::set_brake_limits(const settings::Values& values, const settings::Values& own,
                                  std::uint32_t tick_q16) {
  const Pace pace{tick_q16, fastest_};
  if (pace == brake_pace_ || !make_limits(values, own, pace, new_limits_)) return;
  brake_limits_ = new_limits_;
  brake_pace_ = pace;
}

void WindowPlan::end_attempt(bool found) {
  step_ = Step::ready;
  switch (attempt_) {
    case Attempt::wanted:
      return end_wanted(found);
    case Attempt::before:
      return finish(found);
    case Attempt::longer:
      return end_longer(found);
  }
}

void WindowPlan::end_wanted(bool found) {
  if (found) {
    is_long_ = choose_count();
    if (is_long_ && trying_.tick_q16 != conditions_.long_tick_q16) {
      conditions_.wanted.tick_q16 = trying_.tick_q16 = conditions_.long_tick_q16;
      return;
    }
    if (request_.limits == &new_limits_) {
      limits_ = new_limits_;
      pace_ = trying_;
    }
    return finish(true);
  }
  if (request_.start.at_rest() && trying_.job_speed < wire::full_job_speed) {
    trying_.job_speed = std::min(2 * trying_.job_speed, wire::full_job_speed);
    return;
  }
  count_ = request_.commits();
  if (conditions_.wanted == pace_) return finish(false);
  if (conditions_.wanted.job_speed != pace_.job_speed) request_.rest[count_ - 1] = true;
  attempt_ = Attempt::before;
}

/// Sets the number of segments to hand out. True if they last for longer than short_ticks.
bool WindowPlan::choose_count() {
  count_ = request_.commits();
  if (conditions_.short_ticks == 0) return false;
  std::uint32_t ticks = 0, count = 0, within = 0;
  do {
    ticks += static_cast<std::uint32_t>(segment(count).ticks);
    if (ticks > conditions_.long_ticks && count != 0) break;
    ++count;
    if (ticks <= conditions_.short_ticks) within = count;
  } while (count < count_);
  const bool is_cut = conditions_.may_cut && within >= min_count;
  count_ = is_cut ? within : count;
  return count_ != within;
}

/// A plan was found, or none; with longer ticks there may be a better one. The length of a tick may
/// only change at rest, so the committed part must lie between two rests; its duration is then
/// independent, and the job takes no longer than with nominal ticks.
void WindowPlan::finish(bool found) {
  found_ = found;
  step_ = Step::over;
  if (!found || conditions_.max_tick_q16 == full_tick_q16 || !between_rests()) return;
  attempt_ = Attempt::longer;
  longer_ = 0;
  min_time_ = planned_ticks() * full_tick_q16;
  step_ = Step::ready;
}

void WindowPlan::end_longer(bool found) {
  if (longer_ == longer_tries) {  // repeats the best one
    found_ = found;
    step_ = Step::over;
    return;
  }
  const std::uint32_t tried = longer_tick_q16();
  const std::uint64_t time = found && between_rests() ? planned_ticks() * tried : min_time_;
  if (time < min_time_) {
    min_time_ = time;
    tick_length_q16_ = tried;
  }
  ++longer_;
  if (longer_ == longer_tries && tick_length_q16_ == tried) step_ = Step::over;
}

/// Length of a tick to try: a quarter, half and all of what is permitted, then the best of them.
std::uint32_t WindowPlan::longer_tick_q16() const {
  if (longer_ == longer_tries) return tick_length_q16_;
  return full_tick_q16 +
         ((conditions_.max_tick_q16 - full_tick_q16) >> (longer_tries - 1 - longer_));
}

bool WindowPlan::between_rests() const {
  return request_.start.at_rest() && segment(count_ - 1).end.at_rest();
}

std::uint64_t WindowPlan::planned_ticks() const {
  return segment(count_ - 1).end.tick - request_.start.tick;
}

}  // namespace lamplock::machine
