#include "firmware/motion/path_planner.hpp"

#include "firmware/motion/path_reach.hpp"
#include "firmware/motion/profile.hpp"

namespace lamplock::motion {
namespace {

/// Times tried per label.
constexpr int candidates_per_label = 8;
/// Exact positions are kept as 64 bits beside the middle of a step. After this many ticks, eighteen
/// minutes, rounding has moved them by a quarter of a step.
constexpr std::uint32_t longest_segment_ticks = std::uint32_t{1} << 30;

/// v * factor, rounded down.
std::int64_t scaled(std::int64_t v, Real factor) {
  constexpr std::int64_t largest = std::int64_t{1} << 62;
  const Int128 product = Int128::product(v, factor.mantissa());
  const int shift = -factor.exponent();
  if (shift >= 128) return 0;
  if (shift < 0) return v == 0 ? 0 : largest;
  const Int128 result = product >> shift;
  return result > Int128(largest) ? largest : result.to_int64();
}

std::int64_t least_of(std::int64_t a, std::int64_t b) { return a < b ? a : b; }

/// Steps, Q32, from an exact position to the middle of a step.
std::int64_t way_q32(Int128 from_q64, std::int32_t to_step) {
  return ((stepper::middle_of_step(to_step) - from_q64) >> 32).to_int64();
}

std::int32_t larger(std::int32_t a, std::int32_t b) { return a > b ? a : b; }

/// True if the profile goes against the way it has to go.
bool goes_back(const AxisProfile& p, Int128 way) {
  const std::int64_t cruise = p.cruise_speed_q62();
  return cruise != 0 && (cruise < 0) != way.negative();
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
  const std::uint32_t most = longest_segment_ticks / limits_->beat_ticks;
  most_beats_ = most < max_beats_per_point ? static_cast<std::int32_t>(most) : max_beats_per_point;
  result_ = Result::unreachable;
  phase_ = Phase::set_up;
}

bool PathPlanner::advance() {
  switch (phase_) {
    case Phase::set_up:
      phase_ = set_up(failed_) == Result::ok ? Phase::ahead : Phase::over;
      break;
    case Phase::ahead:
      look_ahead();
      careful_ = false;
      at_ = 0;
      phase_ = Phase::search;
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
  const Target& to = target(i);
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
    stage.displacement_q32 = now.displacement_q32;
    stage.speed_q32 = now.speed_q32;
    stage.corner_q32 = 0;
    stage.from_previous = Real();
    if (i == 0 && !set_start(now)) return Result::unreachable;
    if (i > 0 && !now.none && !before.none) {
      Stage& previous = stages_[i - 1];
      stage.from_previous = speed_factor(before, now);
      const Real corner = corner_speed(before, now, *limits_);
      previous.corner_q32 = least_of(normalised_speed_q32(before, corner), previous.speed_q32);
      const std::int64_t next = scaled(stage.speed_q32, Real(1u) / stage.from_previous);
      previous.corner_q32 = request_->rest[i - 1] ? 0 : least_of(previous.corner_q32, next);
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
  // The speed was made from a normalised one: allow for the rounding of both conversions.
  const std::int64_t slack = 64 + (start_q32_ >> 28);
  const std::int64_t most = normalised_speed_q32(first, jump_speed(motion, first, *limits_));
  // Where this plan follows another one, that one has looked at the corner.
  if (!request_->follows && start_q32_ - slack > least_of(most, first.speed_q32)) return false;
  start_q32_ = least_of(start_q32_, first.speed_q32);
  start_ = {start_q32_ > slack ? start_q32_ - slack : 0,
            least_of(start_q32_ + slack, first.speed_q32)};
  return true;
}

void PathPlanner::look_ahead() {
  stages_[request_->count - 1].end_q32 = 0;
  for (std::uint32_t i = request_->count - 1; i > 0; --i) {
    const Stage& stage = stages_[i];
    Stage& previous = stages_[i - 1];
    previous.end_q32 = previous.corner_q32;
    if (stage.displacement_q32 == 0 || previous.corner_q32 == 0) continue;
    // Run backwards: the fewest beats allow the highest speed.
    const PathWay way{stage.displacement_q32, stage.speed_q32};
    const SpeedInterval end{0, stage.end_q32};
    const std::int32_t fixed = fixed_beats(i);
    const std::int32_t beats =
        fixed != 0 ? fixed : fewest_beats(way, end, way.speed_q32, least_beats(i), most_beats_);
    SpeedInterval start;
    if (beats == 0 || !path_reach(way, end, beats, way.speed_q32, start)) continue;
    const std::int64_t most = scaled(start.hi_q32, Real(1u) / stage.from_previous);
    previous.end_q32 = least_of(previous.end_q32, most);
  }
}

void PathPlanner::search() {
  if (!extend(at_, careful_)) {
    failed_ = at_;
    if (careful_) phase_ = Phase::over;
    // From speed the quickest labels can all end where nothing goes on; the slowest always can.
    careful_ = true;
    at_ = 0;
    return;
  }
  if (++at_ < request_->count) return;
  choose_beats();
  choose_speeds();
  at_ = 0;
  phase_ = Phase::check;
}

bool PathPlanner::extend(std::uint32_t i, bool careful) {
  stages_[i].beam.count = 0;
  if (!beats_allowed(i)) return false;
  const std::uint32_t parents = i == 0 ? 1 : stages_[i - 1].beam.count;
  for (std::uint32_t p = 0; p < parents; ++p) extend(i, p, careful);
  return stages_[i].beam.count != 0;
}

bool PathPlanner::beats_allowed(std::uint32_t i) const {
  const std::int32_t fixed = fixed_beats(i);
  if (fixed == 0) return true;
  return fixed <= most_beats_ && (target(i).shots == 0 || fixed >= request_->least_beats);
}

std::int32_t PathPlanner::fixed_beats(std::uint32_t i) const {
  return request_->at_least[i] != 0 ? 0 : target(i).beats;
}

std::int32_t PathPlanner::least_beats(std::uint32_t i) const {
  const std::int32_t least = larger(1, request_->at_least[i]);
  return target(i).shots == 0 ? least : larger(least, request_->least_beats);
}

SpeedInterval PathPlanner::start_speeds(std::uint32_t i, const SpeedInterval& end) const {
  const Stage& stage = stages_[i];
  const std::int64_t lo = scaled(end.lo_q32, stage.from_previous);
  const std::int64_t hi = scaled(end.hi_q32, stage.from_previous);
  return {least_of(lo, stage.speed_q32), least_of(hi, stage.speed_q32)};
}

bool PathPlanner::step(std::uint32_t i, const SpeedInterval& from, std::int32_t beats,
                       SpeedInterval& to) const {
  const Stage& stage = stages_[i];
  to = {0, 0};
  if (stage.displacement_q32 == 0) return from.lo_q32 == 0;
  return path_reach({stage.displacement_q32, stage.speed_q32}, from, beats, stage.end_q32, to);
}

/// Fewest beats from speeds at the start of line i to its end; 0 = there is no way.
std::int32_t PathPlanner::first_beats(std::uint32_t i, const SpeedInterval& from) const {
  const Stage& stage = stages_[i];
  const std::int32_t fixed = fixed_beats(i);
  SpeedInterval to;
  if (fixed != 0) return step(i, from, fixed, to) ? fixed : 0;
  if (stage.displacement_q32 == 0) return from.lo_q32 == 0 ? least_beats(i) : 0;
  return fewest_beats({stage.displacement_q32, stage.speed_q32}, from, stage.end_q32,
                      least_beats(i), most_beats_);
}

void PathPlanner::extend(std::uint32_t i, std::uint32_t parent, bool careful) {
  const Label* const before = i == 0 ? nullptr : &stages_[i - 1].beam.labels[parent];
  const SpeedInterval from = before == nullptr ? start_ : start_speeds(i, before->speeds);
  std::int32_t beats = before == nullptr ? first_beats(i, from) : before->next;
  for (int tries = 0; beats != 0 && tries < candidates_per_label; ++tries, ++beats) {
    Label label{};
    if (beats > most_beats_ || !step(i, from, beats, label.speeds)) return;
    const std::uint32_t total = before == nullptr ? 0 : before->total;
    label.total = (total + static_cast<std::uint32_t>(beats)) & 0xffffffu;
    label.parent = static_cast<std::uint8_t>(parent);
    label.beats = static_cast<std::uint16_t>(beats);
    keep(i, label, careful);
    // With more beats the interval only moves down, and can no further.
    if (fixed_beats(i) != 0 || label.speeds.lo_q32 == 0) return;
  }
}

void PathPlanner::keep(std::uint32_t i, Label label, bool careful) {
  Beam& beam = stages_[i].beam;
  for (std::uint32_t k = 0; k < beam.count; ++k)
    if (beam.labels[k].total <= label.total && beam.labels[k].speeds.contains(label.speeds)) return;
  if (i + 1 < request_->count) {
    const std::int32_t next = first_beats(i + 1, start_speeds(i + 1, label.speeds));
    if (next == 0) return;
    label.next = static_cast<std::uint16_t>(next);
  }
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < beam.count; ++k) {
    const Label other = beam.labels[k];
    if (label.total <= other.total && label.speeds.contains(other.speeds)) continue;
    beam.labels[kept++] = other;
  }
  beam.count = kept;
  if (kept < path_labels) {
    beam.labels[beam.count++] = label;
    return;
  }
  // Full: the worst goes, but never the quickest of those that can rest, whatever comes behind.
  const auto better = [careful](const Label& a, const Label& b) {
    if (careful && a.speeds.lo_q32 != b.speeds.lo_q32) return a.speeds.lo_q32 < b.speeds.lo_q32;
    const std::uint32_t ra = a.total + a.next, rb = b.total + b.next;
    return ra != rb ? ra < rb : a.speeds.hi_q32 > b.speeds.hi_q32;
  };
  const Label* rest = label.speeds.lo_q32 == 0 ? &label : nullptr;
  for (const Label& other : beam.labels)
    if (other.speeds.lo_q32 == 0 && (rest == nullptr || other.total < rest->total)) rest = &other;
  Label* worst = rest == &label ? nullptr : &label;
  for (Label& other : beam.labels)
    if (&other != rest && (worst == nullptr || better(*worst, other))) worst = &other;
  if (worst != &label) *worst = label;
}

void PathPlanner::choose_beats() {
  std::uint32_t chosen = 0;
  for (std::uint32_t i = request_->count; i-- > 0;) {
    const Label label = stages_[i].beam.labels[chosen];
    chosen = label.parent;
    stages_[i].chosen = Chosen{label.speeds, 0, {}, label.total, label.beats};
  }
}

void PathPlanner::choose_speeds() {
  for (std::uint32_t i = request_->count - 1; i-- > 0;) {
    Chosen& here = stages_[i].chosen;
    const Stage& next = stages_[i + 1];
    here.speed_q32 = 0;
    if (next.displacement_q32 == 0 || here.speeds.hi_q32 == 0) continue;
    // Run backwards from the speed at the end of the next line. Bounds are rounded inwards, so a
    // speed on a bound needs a hair of width not to be lost.
    const std::int64_t end = next.chosen.speed_q32;
    const std::int64_t slack = 8 + 4 * next.chosen.beats + (end >> 28);
    const SpeedInterval wanted{end > slack ? end - slack : 0,
                               least_of(end + slack, next.speed_q32)};
    SpeedInterval both = here.speeds;
    SpeedInterval can;
    if (path_reach({next.displacement_q32, next.speed_q32}, wanted, next.chosen.beats,
                   next.speed_q32, can)) {
      const Real back = Real(1u) / next.from_previous;
      both.lo_q32 = both.clamp(scaled(can.lo_q32, back));
      both.hi_q32 = here.speeds.clamp(scaled(can.hi_q32, back));
    }
    here.speed_q32 = both.clamp(wanted_speed_q32(i));
  }
}

/// Mean speed over both lines at a point.
std::int64_t PathPlanner::wanted_speed_q32(std::uint32_t i) const {
  const Stage &here = stages_[i], &next = stages_[i + 1];
  const std::int64_t behind = scaled(next.displacement_q32, Real(1u) / next.from_previous);
  return (here.displacement_q32 + least_of(behind, max_displacement_q32)) /
         (here.chosen.beats + next.chosen.beats);
}

/// Makes a segment and looks at it. Where it is not good one more point at least becomes a full
/// stop, and the window is planned anew: at most as often as it has points.
void PathPlanner::check() {
  const std::uint32_t i = at_;
  const MotionState from = state_before(i);
  const Segment s = make_segment(i, from);
  Stage& stage = stages_[i];
  for (int a = 0; a < limits_->axes; ++a) {
    const Int128 off =
        s.end.axis[index(a)].position_q64 - stepper::middle_of_step(target(i).steps[index(a)]);
    stage.chosen.off_q64[index(a)] = off.to_int64();
  }
  const bool in = inside(s, from);
  if (in && can_stop(s)) {
    if (++at_ < request_->count) return;
    result_ = Result::ok;
    phase_ = Phase::over;
    return;
  }
  const bool had_rest = stage.corner_q32 == 0 && (in || i == 0 || stages_[i - 1].corner_q32 == 0);
  stage.corner_q32 = 0;
  if (!in && i > 0) stages_[i - 1].corner_q32 = 0;
  failed_ = 0;
  phase_ = had_rest ? Phase::over : Phase::ahead;
}

bool PathPlanner::inside(const Segment& s, const MotionState& from) const {
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const AxisProfile& profile = s.axis[index(a)];
    if (!within_limits(profile, axis.speed_q62, axis.accel_q62)) return false;
    const Int128 start = from.axis[index(a)].position_q64, end = s.end.axis[index(a)].position_q64;
    Int128 low = start < end ? start : end, high = start < end ? end : start;
    if (goes_back(profile, end - start)) {
      const Excursion e = excursion(profile);
      low = start + (e.low_q62 << 2);
      high = start + (e.high_q62 << 2);
    }
    if (low.hi() < axis.min_steps || high.hi() > axis.max_steps) return false;
  }
  return true;
}

bool PathPlanner::can_stop(const Segment& s) const {
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const AxisState& end = s.end.axis[index(a)];
    if (end.speed_q62 == 0) continue;
    // Half the time at the speed, rounded up.
    const std::int64_t ticks = std::int64_t{braking_ticks(end.speed_q62, axis.plan_accel_q62)} + 1;
    const std::int64_t stop =
        (end.position_q64 + (Int128::product(end.speed_q62, ticks) << 1)).hi();
    if (stop < axis.min_steps || stop > axis.max_steps) return false;
  }
  return true;
}

std::int64_t PathPlanner::start_speed_q32(std::uint32_t i) const {
  if (i == 0) return start_q32_;
  return least_of(scaled(stages_[i - 1].chosen.speed_q32, stages_[i].from_previous),
                  stages_[i].speed_q32);
}

Segment PathPlanner::make_segment(std::uint32_t i, const MotionState& from) const {
  const Stage& stage = stages_[i];
  const Target& to = target(i);
  const PathLine path = line(i);
  Segment s;
  s.start_tick = from.tick;
  s.ticks = static_cast<std::uint32_t>(stage.chosen.beats) * limits_->beat_ticks;
  s.ends_point = true;
  s.point = request_->points[i];
  s.end.tick = s.end_tick();
  const PerAxis<std::int64_t> v0 = axis_speeds_q62(path, start_speed_q32(i), limits_->beat_ticks);
  const PerAxis<std::int64_t> v1 =
      axis_speeds_q62(path, stage.chosen.speed_q32, limits_->beat_ticks);
  PerAxis<Int128> way{};
  int longest = 0;
  for (int a = 0; a < limits_->axes; ++a) {
    way[index(a)] =
        (stepper::middle_of_step(to.steps[index(a)]) - from.axis[index(a)].position_q64) >> 2;
    if (abs64(path.way[index(a)]) > abs64(path.way[index(longest)])) longest = a;
  }
  // The phases of the longest axis are those of all.
  const std::int64_t half =
      abs64(axis_speeds_q62(path, stage.speed_q32, limits_->beat_ticks)[index(longest)]) / 2;
  AxisProfile phases;
  if (path.none) {
    phases.lead_ticks = s.ticks / 2;
    phases.tail_ticks = s.ticks - phases.lead_ticks;
  } else {
    const Int128 forth = path.way[index(longest)] < 0 ? -way[index(longest)] : way[index(longest)];
    phases = make_profile(forth - Int128::product(half, s.ticks), abs64(v0[index(longest)]) - half,
                          abs64(v1[index(longest)]) - half, s.ticks, half);
  }
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisProfile profile =
        make_phases(way[index(a)], v0[index(a)], v1[index(a)], phases.lead_ticks,
                    phases.cruise_ticks, phases.tail_ticks);
    s.axis[index(a)] = profile;
    s.end.axis[index(a)] = {
        from.axis[index(a)].position_q64 + (stepper::displacement_q62(profile) << 2), v1[index(a)]};
  }
  if (to.shots != 0) s.shot = {true, shot_window_ticks(i, v1), to.channel, to.energy};
  return s;
}

Segment PathPlanner::segment(std::uint32_t i) const { return make_segment(i, state_before(i)); }

MotionState PathPlanner::state_before(std::uint32_t i) const {
  if (i == 0) return request_->start;
  const Chosen& chosen = stages_[i - 1].chosen;
  MotionState state;
  state.tick = request_->start.tick + std::uint64_t{chosen.total} * limits_->beat_ticks;
  const PerAxis<std::int64_t> speeds =
      axis_speeds_q62(line(i - 1), chosen.speed_q32, limits_->beat_ticks);
  for (int a = 0; a < limits_->axes; ++a)
    state.axis[index(a)] = {
        stepper::middle_of_step(target(i - 1).steps[index(a)]) + Int128(chosen.off_q64[index(a)]),
        speeds[index(a)]};
  return state;
}

std::uint32_t PathPlanner::shot_window_ticks(std::uint32_t i,
                                             const PerAxis<std::int64_t>& before) const {
  // |speed| <= v + A t on both sides of the point: v t + A t^2 / 2 = tolerance.
  // Never more than a quarter beat: an edge that far off belongs to no beat.
  PerAxis<std::int64_t> behind{};
  if (i + 1 < request_->count)
    behind = axis_speeds_q62(line(i + 1), start_speed_q32(i + 1), limits_->beat_ticks);
  std::int64_t least_q32 = one_q32 / 4;
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int64_t one = abs64(before[index(a)]), other = abs64(behind[index(a)]);
    const std::int64_t per_beat_q32 =
        (Int128::product(one > other ? one : other, limits_->beat_ticks) >> 30).to_int64();
    const std::int64_t v = axis.displacement_q32(per_beat_q32);
    const std::int64_t root = sqrt_down_q32(mul_q32(v, v) + 2 * axis.shot_way_q32);
    least_q32 = least_of(least_q32, root > v ? root - v : 0);
  }
  return static_cast<std::uint32_t>((least_q32 * limits_->beat_ticks) >> 32);
}

}  // namespace lamplock::motion
