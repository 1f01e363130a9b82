// Between positions and the search: a window is set up from exact positions, and the beats and
// speeds found for it become segments, which are checked.
#include "firmware/motion/free/planner.hpp"
#include "firmware/motion/profile/profile.hpp"
#include "firmware/motion/profile/pulse.hpp"

namespace lamplock::motion {
namespace {

/// Ticks of a segment have 31 bits.
constexpr std::uint32_t max_segment_ticks = 0x7fffffff;
/// Tolerance so that the end speed of a plan is a feasible start speed of the next one.
constexpr std::int32_t start_slack_qs = 2 * rounding_tolerance_qs;
/// Share of a braking distance reserved for rounding: 1/256.
constexpr int ramp_share_bits = 8;

/// Displacement in steps, Q32, from an exact position to the middle of a step.
std::int64_t way_q32(Int128 from_q64, std::int32_t to_step) {
  return ((stepper::middle_of_step(to_step) - from_q64) >> 32).to_int64();
}

/// True if the speed changes its sign between start and end.
bool reverses(const AxisProfile& p) {
  const std::int64_t cruise = p.cruise_speed_q62(), end = p.end_speed_q62();
  const bool some_forth = p.speed_q62 > 0 || cruise > 0 || end > 0;
  const bool some_back = p.speed_q62 < 0 || cruise < 0 || end < 0;
  return some_forth && some_back;
}

/// Upper bound of the steps of a profile in any direction: all the time at its highest speed.
std::int64_t max_way_steps(const AxisProfile& p) {
  std::int64_t speed_q62 = abs64(p.speed_q62);
  for (const std::int64_t other : {abs64(p.cruise_speed_q62()), abs64(p.end_speed_q62())})
    if (other > speed_q62) speed_q62 = other;
  const auto speed_q30 = static_cast<std::uint32_t>(speed_q62 >> 32) + 1;
  return static_cast<std::int64_t>(wide_product(speed_q30, p.ticks()) >> 30) + 1;
}

/// Highest speed from which full braking stops within a distance: v^2 / 2 = distance, at most the
/// limit.
std::int32_t braking_speed_qs(const AxisLimits& axis, std::int64_t steps) {
  if (steps <= 0) return 0;
  // Ramps of whole ticks are up to a few parts in a thousand too long.
  const auto all = static_cast<std::uint64_t>(axis.displacement_qs(steps));
  const std::uint64_t way = all - (all >> ramp_share_bits);
  if (way >= axis.scale.far / 8) return axis.scale.limit_qs;
  return static_cast<std::int32_t>(nearly_isqrt(way << (axis.scale.bits + 1)));
}

}  // namespace

void Planner::begin(const PlanRequest& request) {
  request_ = &request;
  limits_ = request.limits;
  result_ = Result::unreachable;
  if (request.mode == wire::JoinMode::path) {
    path_.begin(request);
    at_ = 0;
    phase_ = Phase::path;
    return;
  }
  window_.limits = limits_;
  window_.count = request.count;
  const std::uint32_t most = max_segment_ticks / limits_->beat_ticks;
  window_.max_beats =
      most < max_beats_per_point ? static_cast<std::int32_t>(most) : max_beats_per_point;
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int64_t per_beat_q32 =
        (Int128::product(request.start.axis[index(a)].speed_q62, limits_->beat_ticks) >> 30)
            .to_int64();
    // Rounded to nearest, which most likely is the end speed of the previous plan.
    const std::int64_t half = std::int64_t{1} << (31 - axis.scale.bits);
    const std::int32_t v =
        axis.scale.range().clamp(axis.scale.scaled(axis.displacement_q32(per_beat_q32) + half));
    start_qs_[index(a)] = v;
    const std::int32_t slack = v == 0 ? 0 : start_slack_qs;
    window_.start[index(a)] = {v - slack, v + slack};
  }
  begin_search(request.mode == wire::JoinMode::free);
}

bool Planner::set_up() {
  for (std::uint32_t i = 0; i < request_->count; ++i) {
    if (set_up_way(i)) continue;
    fail(i);
    return false;
  }
  return true;
}

bool Planner::set_up_way(std::uint32_t i) {
  Leg& way = window_.ways[i];
  const bool rest = request_->mode == wire::JoinMode::start_stop || request_->rest[i] ||
                    (i + 1 == request_->count && request_->rest_at_end);
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int32_t steps = target(i).steps[index(a)];
    const std::int64_t q =
        i == 0
            ? axis.displacement_q32(way_q32(request_->start.axis[index(a)].position_q64, steps)) >>
                  (32 - axis.scale.bits)
            : axis.displacement_qs(std::int64_t{steps} - target(i - 1).steps[index(a)]);
    if (abs64(q) > max_displacement_q32 >> (32 - axis.scale.bits)) return false;
    way.displacement_qs[index(a)] = q;
    way.allowed[index(a)] = rest ? SpeedRange{} : allowed_speeds(axis, steps);
  }
  return set_beats(way, i);
}

SpeedRange Planner::allowed_speeds(const AxisLimits& axis, std::int32_t steps) const {
  const std::int64_t below = std::int64_t{steps} - axis.min_steps;
  const std::int64_t above = std::int64_t{axis.max_steps} - steps;
  const std::int64_t way = below < above ? below : above;
  const std::int32_t speed = axis.jerk_q78 == 0
                                 ? braking_speed_qs(axis, way)
                                 : pulse_braking_speed_qs(axis, limits_->beat_ticks, way);
  return {-speed, speed};
}

bool Planner::set_beats(Leg& way, std::uint32_t i) const {
  const std::int32_t at_least = request_->at_least[i];
  way.fixed_beats = at_least != 0 ? 0 : target(i).beats;
  const bool hurried = target(i).shots == 0 && way.fixed_beats != 0;
  std::int64_t first = hurried ? 1 : request_->min_beats;
  if (at_least > first) first = at_least;
  for (int a = 0; a < limits_->axes; ++a) {
    const std::int64_t q = abs64(way.displacement_qs[index(a)]);
    const std::int32_t limit = limits_->axis[index(a)].scale.limit_qs;
    if (q >= limit * first) first = q / limit + 1;
  }
  if (first > window_.max_beats) return false;
  way.first_beats = static_cast<std::int32_t>(first);
  if (way.fixed_beats != 0)
    return way.fixed_beats >= way.first_beats && way.fixed_beats <= window_.max_beats;
  const std::int32_t at_rest = beats_at_rest(window_, way, window_.max_beats);
  way.last_beats = at_rest + beats_beyond_rest;
  if (way.last_beats > window_.max_beats) way.last_beats = window_.max_beats;
  return at_rest != 0;
}

void Planner::make_segments() {
  const MotionState& from = at_ == 0 ? request_->start : segments_[at_ - 1].end;
  make_segment(at_, from);
  for (int a = 0; a < limits_->axes; ++a) {
    if (fit_axis(at_, a, from)) continue;
    misfits_ |= 1u << at_;
  }
  if (++at_ < request_->commits()) return;
  if (misfits_ != 0) return take_longer();
  result_ = Result::ok;
  phase_ = Phase::over;
}

/// Planned speed at the end of a way. If it equals the mean speed within rounding, the mean speed:
/// then an equal way after it needs no acceleration.
std::int64_t Planner::end_speed_q62(std::uint32_t i, int a, Int128 way_q62) const {
  const std::int64_t speed = limits_->speed_q62(a, speed_q32(i, a));
  if (speed == 0) return 0;
  // As precise as possible without a long division.
  const std::int32_t near_qs =
      mean_speed(window_.ways[i].displacement_qs[index(a)], beats_[i]).down_qs;
  if (abs64(std::int64_t{speed_qs_[i][index(a)]} - near_qs) > 2 * rounding_tolerance_qs)
    return speed;
  const std::int64_t mean =
      way_q62.divided_by(static_cast<std::uint32_t>(beats_[i]) * limits_->beat_ticks).to_int64();
  const AxisScale& scale = limits_->axis[index(a)].scale;
  return abs64(speed - mean) <= limits_->speed_q62(a, scale.q32(rounding_tolerance_qs)) ? mean
                                                                                        : speed;
}

/// Changes the profile of an axis to keep all limits; false if none does.
bool Planner::fit_axis(std::uint32_t i, int a, const MotionState& from) {
  if (axis_inside(i, a, from)) return true;
  make_steady(i, a, from);
  if (axis_inside(i, a, from)) return true;
  return limits_->axis[index(a)].jerk_q78 != 0 && fit_pulses(i, a, from);
}

/// The same where the quietest phases are too short for their pulses.
bool Planner::fit_pulses(std::uint32_t i, int a, const MotionState& from) {
  for (std::uint32_t choice = 0; choice < phase_choices; ++choice) {
    const AxisState& start = from.axis[index(a)];
    set_profile(i, a, from,
                make_choice(choice, way_q62(i, a, from), start.speed_q62,
                            segments_[i].end.axis[index(a)].speed_q62, segments_[i].ticks));
    if (axis_inside(i, a, from)) return true;
  }
  return false;
}

void Planner::make_segment(std::uint32_t i, const MotionState& from) {
  Segment& s = segments_[i];
  s = Segment{};
  s.start_tick = from.tick;
  s.ticks = static_cast<std::uint32_t>(beats_[i]) * limits_->beat_ticks;
  s.ends_point = true;
  s.point = request_->points[i];
  s.end.tick = s.end_tick();
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisState& axis = from.axis[index(a)];
    const Int128 way = way_q62(i, a, from);
    const std::int64_t end_speed = end_speed_q62(i, a, way);
    AxisProfile profile;
    const bool cruise = make_cruise(way, axis.speed_q62, end_speed, s.ticks, profile);
    if (!cruise)
      profile = make_profile(way, axis.speed_q62, end_speed, s.ticks,
                             limits_->axis[index(a)].plan_speed_q62);
    s.end.axis[index(a)].speed_q62 = cruise ? axis.speed_q62 : end_speed;
    set_profile(i, a, from, profile);
  }
  if (target(i).shots != 0)
    s.shot = {true, shot_window_ticks(i), target(i).channel, target(i).energy};
}

/// Displacement of an axis, from its exact position.
Int128 Planner::way_q62(std::uint32_t i, int a, const MotionState& from) const {
  return (stepper::middle_of_step(target(i).steps[index(a)]) - from.axis[index(a)].position_q64) >>
         2;
}

void Planner::set_profile(std::uint32_t i, int a, const MotionState& from,
                          const AxisProfile& profile) {
  AxisProfile& p = segments_[i].axis[index(a)];
  AxisState& end = segments_[i].end.axis[index(a)];
  p = profile;
  if (const std::int64_t jerk = limits_->axis[index(a)].jerk_q78; jerk != 0)
    make_pulses(p, end.speed_q62, jerk);
  end.position_q64 = from.axis[index(a)].position_q64 + (stepper::displacement_q62(p) << 2);
}

/// The profile with the least excursion, where the quiet one leaves the work space.
void Planner::make_steady(std::uint32_t i, int a, const MotionState& from) {
  const AxisScale& scale = limits_->axis[index(a)].scale;
  const std::int64_t v0 = start_q32(i, a), v1 = speed_q32(i, a);
  const std::int64_t steady = steady_speed_q32(
      window_.ways[i].displacement_qs[index(a)] << (32 - scale.bits), v0, v1, beats_[i]);
  const auto ticks = [this](std::int64_t change_q32) {
    return static_cast<std::uint32_t>(mul_q32(abs64(change_q32), limits_->beat_ticks)) + 1;
  };
  set_profile(i, a, from,
              make_steady_profile(way_q62(i, a, from), from.axis[index(a)].speed_q62,
                                  segments_[i].end.axis[index(a)].speed_q62, segments_[i].ticks,
                                  ticks(steady - v0), ticks(steady - v1),
                                  limits_->axis[index(a)].accel_q62));
}

bool Planner::axis_inside(std::uint32_t i, int a, const MotionState& from) const {
  const AxisLimits& axis = limits_->axis[index(a)];
  const AxisProfile& profile = segments_[i].axis[index(a)];
  if (!within_limits(profile, axis.speed_q62, axis.accel_q62)) return false;
  if (!keeps_jerk(profile, axis.jerk_q78)) return false;
  const Int128 start = from.axis[index(a)].position_q64;
  const std::int64_t end = segments_[i].end.axis[index(a)].position_q64.hi();
  const std::int64_t beyond = reverses(profile) ? max_way_steps(profile) : 0;
  const std::int64_t low = start.hi() < end ? start.hi() : end;
  const std::int64_t high = start.hi() < end ? end : start.hi();
  if (low - beyond >= axis.min_steps && high + beyond <= axis.max_steps) return true;
  if (beyond == 0) return false;
  const Excursion e = excursion(profile);
  return (start + (e.low_q62 << 2)).hi() >= axis.min_steps &&
         (start + (e.high_q62 << 2)).hi() <= axis.max_steps;
}

std::uint32_t Planner::shot_window_ticks(std::uint32_t i) const {
  // |speed| <= v + A t on both sides of the point: v t + A t^2 / 2 = tolerance.
  // Never more than a quarter beat: an edge that far off belongs to no beat.
  std::uint32_t least = limits_->beat_ticks / 4;
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const int bits = axis.scale.bits;
    const std::int32_t v = speed_qs_[i][index(a)];
    const auto speed = static_cast<std::uint32_t>(v < 0 ? -v : v);
    const auto way = static_cast<std::uint64_t>(axis.shot_way_q32 >> (32 - bits));
    if (way >= (speed >> 2) + (std::uint32_t{1} << bits >> 5)) continue;  // enough for a quarter
    const std::uint32_t root = nearly_isqrt(wide_product(speed, speed) + (way << (bits + 1)));
    const std::uint64_t t = root > speed ? root - speed : 0;
    const auto ticks = static_cast<std::uint32_t>(t * limits_->beat_ticks >> bits);
    if (ticks < least) least = ticks;
  }
  return least;
}

}  // namespace lamplock::motion
