// The course of a plan of a path: set-up, look-ahead, and the choice of beats and speeds.
#include "firmware/motion/path/planner.hpp"

#include "firmware/motion/path/reach.hpp"

namespace lamplock::motion {
namespace {

/// Exact positions are stored as 64-bit offsets from the middle of a step. After this many ticks,
/// eighteen minutes, rounding has moved them by a quarter of a step; pulses are rounded to larger
/// units.
constexpr std::uint32_t max_segment_ticks = std::uint32_t{1} << 30;
constexpr std::uint32_t max_pulses_ticks = std::uint32_t{1} << 28;
/// The search for the highest speed skips this share of the beats.
constexpr std::int32_t beats_share = 16;

std::int64_t min_of(std::int64_t a, std::int64_t b) { return a < b ? a : b; }

/// Steps, Q32, from an exact position to the middle of a step.
std::int64_t way_q32(Int128 from_q64, std::int32_t to_step) {
  return ((stepper::middle_of_step(to_step) - from_q64) >> 32).to_int64();
}

}  // namespace

Result PathPlanner::plan(const PlanRequest& request, std::uint32_t& failed) {
  begin(request);
  while (advance()) {
  }
  if (result_ != Result::ok) failed = failed_;
  return result_;
}

void PathPlanner::begin(const PlanRequest& request) {
  request_ = &request;
  limits_ = request.limits;
  jerk_limited_ = limits_->jerk_limited();
  const std::uint32_t ticks = jerk_limited_ ? max_pulses_ticks : max_segment_ticks;
  const std::uint32_t most = ticks / limits_->beat_ticks;
  max_beats_ = most < max_beats_per_point ? static_cast<std::int32_t>(most) : max_beats_per_point;
  result_ = Result::unreachable;
  phase_ = Phase::set_up;
}

bool PathPlanner::advance() {
  switch (phase_) {
    case Phase::set_up:
      phase_ = Phase::over;
      if (set_up(failed_) == Result::ok) start_over();
      break;
    case Phase::ahead:
      look_ahead();
      break;
    case Phase::search:
      search();
      break;
    case Phase::check:
      check();
      break;
    case Phase::over:
      break;
  }
  return phase_ != Phase::over;
}

PathLine PathPlanner::line(std::uint32_t i) const {
  PerAxis<std::int64_t> way{};
  const wire::Target& to = target(i);
  for (int a = 0; a < limits_->axes; ++a)
    way[index(a)] =
        i == 0 ? way_q32(request_->start.axis[index(a)].position_q64, to.steps[index(a)])
               : (std::int64_t{to.steps[index(a)]} - target(i - 1).steps[index(a)]) * one_q32;
  return make_line(way, *limits_);
}

Result PathPlanner::set_up(std::uint32_t& failed) {
  PathLine before;
  for (std::uint32_t i = 0; i < request_->count; ++i) {
    const PathLine now = line(i);
    failed = i;
    if (now.displacement_q32 > max_displacement_q32) return Result::unreachable;
    if (!now.none && now.speed_q32 <= 0) return Result::unreachable;
    Stage& stage = stages_[i];
    stage.line = {now.displacement_q32, now.speed_q32};
    if (now.rise_q32 != 0)
      stage.line = make_pulse_line(now.displacement_q32, now.speed_q32, now.rise_q32, now.flat_q32);
    stage.corner_q32 = 0;
    stage.hint = 1;
    stage.from_previous = Real();
    if (i == 0 && !set_start(now)) return Result::unreachable;
    if (i > 0 && !now.none && !before.none) {
      Stage& previous = stages_[i - 1];
      stage.from_previous = speed_factor(before, now);
      const Real corner = corner_speed(before, now, *limits_);
      previous.corner_q32 = min_of(normalised_speed_q32(before, corner), previous.line.speed_q32);
      const std::int64_t next = scaled(stage.line.speed_q32, Real(1u) / stage.from_previous);
      previous.corner_q32 = request_->rest[i - 1] ? 0 : min_of(previous.corner_q32, next);
    }
    before = now;
  }
  return Result::ok;
}

bool PathPlanner::set_start(const PathLine& first) {
  start_q32_ = 0;
  start_ = {0, 0};
  if (request_->start.at_rest()) return true;
  if (first.none) return false;
  PerAxis<std::int64_t> speeds{};
  for (int a = 0; a < limits_->axes; ++a)
    speeds[index(a)] = request_->start.axis[index(a)].speed_q62;
  Real speed;
  const PathLine motion = line_of_speed(speeds, *limits_, speed);
  start_q32_ = normalised_speed_q32(first, speed);
  // The speed was made from a normalised one: allow for the rounding of both conversions. Where
  // jerk is limited speeds are on bounds more often, and the profiles have more room.
  const std::int64_t slack = 64 + (start_q32_ >> (jerk_limited_ ? 22 : 28));
  const std::int64_t most = normalised_speed_q32(first, jump_speed(motion, first, *limits_));
  // If this plan follows another one, that one has checked the corner.
  if (!request_->follows && start_q32_ - slack > min_of(most, first.speed_q32)) return false;
  start_q32_ = min_of(start_q32_, first.speed_q32);
  start_ = {start_q32_ > slack ? start_q32_ - slack : 0,
            min_of(start_q32_ + slack, first.speed_q32)};
  return true;
}

void PathPlanner::start_over() {
  phase_ = Phase::ahead;
  at_ = request_->count - 1;
  stages_[at_].end_q32 = 0;
  careful_ = false;
}

/// Looks ahead over one point: from its end to the start of its line.
void PathPlanner::look_ahead() {
  if (at_ == 0) {
    phase_ = Phase::search;
    return;
  }
  const Stage& stage = stages_[at_];
  Stage& previous = stages_[at_ - 1];
  previous.end_q32 = previous.corner_q32;
  if (!stage.is_at_rest() && previous.corner_q32 != 0) {
    const std::int64_t most = scaled(start_bound_q32(at_), Real(1u) / stage.from_previous);
    previous.end_q32 = min_of(previous.end_q32, most);
  }
  --at_;
}

/// Highest speed at the start of a line, in its units.
std::int64_t PathPlanner::start_bound_q32(std::uint32_t i) {
  const Stage& stage = stages_[i];
  const SpeedInterval end{0, stage.end_q32};
  std::int64_t most = max_start_q32(i, end);
  // Long pulses remove more speed than short ones: rest at the end may allow more.
  if (stage.has_pulses()) {
    const std::int64_t to_rest = max_start_q32(i, {0, 0});
    if (to_rest > most) most = to_rest;
  }
  return most < 0 ? stage.line.speed_q32 : most;
}

/// The same for given speeds at the end; negative if there is none. Seen from the end the fewest
/// beats allow it; not where jerk is limited: there it rises with the length of the pulses and
/// falls again.
std::int64_t PathPlanner::max_start_q32(std::uint32_t i, const SpeedInterval& end) {
  const Stage& stage = stages_[i];
  const std::int32_t fixed = fixed_beats(i);
  const std::int32_t first = fixed != 0 ? fixed : fewest(i, end, stage.line.speed_q32);
  if (first == 0) return -1;
  std::int64_t most = max_start_q32(i, end, first);
  if (fixed != 0 || !stage.has_pulses()) return most;
  int falls = 0;
  for (std::int32_t k = first + 1; falls < 2 && k <= max_beats_; k += 1 + k / beats_share) {
    const std::int64_t speed = max_start_q32(i, end, k);
    falls = speed > most ? 0 : falls + 1;
    if (speed > most) most = speed;
  }
  return most;
}

/// The same for a given number of beats; negative if there is none.
std::int64_t PathPlanner::max_start_q32(std::uint32_t i, const SpeedInterval& end,
                                        std::int32_t beats) const {
  std::int64_t most = -1;
  for (int split = 0; split < stages_[i].splits(); ++split) {
    SpeedInterval start;
    if (step_back(i, end, beats, split, start) && start.hi_q32 > most) most = start.hi_q32;
  }
  return most;
}

void PathPlanner::choose_beats() {
  std::uint32_t chosen = 0;
  for (std::uint32_t i = request_->count; i-- > 0;) {
    const Label label = stages_[i].beam.labels[chosen];
    chosen = label.parent;
    stages_[i].chosen = Chosen{label.speeds, 0, {}, label.total, label.beats, label.split};
  }
}

void PathPlanner::choose_speeds() {
  for (std::uint32_t i = request_->count - 1; i-- > 0;) choose_speed(i);
}

/// Chooses the speed at a point from that at the next one.
void PathPlanner::choose_speed(std::uint32_t i) {
  Chosen& here = stages_[i].chosen;
  const Stage& next = stages_[i + 1];
  here.speed_q32 = 0;
  if (next.is_at_rest() || here.speeds.hi_q32 == 0) return;
  // Run backwards from the speed at the end of the next line. Bounds are rounded inwards, so a
  // speed on a bound needs a small tolerance to be found again.
  const std::int64_t end = next.chosen.speed_q32;
  const std::int64_t slack = 8 + 4 * next.chosen.beats + (end >> 28);
  const SpeedInterval wanted{end > slack ? end - slack : 0,
                             min_of(end + slack, next.line.speed_q32)};
  SpeedInterval both = here.speeds;
  SpeedInterval can;
  if (step_back(i + 1, wanted, next.chosen.beats, next.chosen.split, can)) {
    const Real back = Real(1u) / next.from_previous;
    both.lo_q32 = both.clamp(scaled(can.lo_q32, back));
    both.hi_q32 = here.speeds.clamp(scaled(can.hi_q32, back));
  }
  here.speed_q32 = both.clamp(wanted_speed_q32(i));
}

/// Mean speed over both lines at a point.
std::int64_t PathPlanner::wanted_speed_q32(std::uint32_t i) const {
  const Stage &here = stages_[i], &next = stages_[i + 1];
  const std::int64_t way_after = scaled(next.line.displacement_q32, Real(1u) / next.from_previous);
  return (here.line.displacement_q32 + min_of(way_after, max_displacement_q32)) /
         (here.chosen.beats + next.chosen.beats);
}

}  // namespace lamplock::motion
