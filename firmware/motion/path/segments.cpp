// The segments of a path: made from the beats and speeds that were found, and checked.
#include "firmware/motion/path/planner.hpp"
#include "firmware/motion/profile/profile.hpp"
#include "firmware/motion/profile/pulse.hpp"

namespace lamplock::motion {
namespace {

std::int64_t min_of(std::int64_t a, std::int64_t b) { return a < b ? a : b; }

/// True if the profile moves against its displacement.
bool goes_back(const AxisProfile& p, Int128 way) {
  const std::int64_t cruise = p.cruise_speed_q62();
  return cruise != 0 && (cruise < 0) != way.negative();
}

}  // namespace

/// Makes a segment and checks it.
void PathPlanner::check() {
  const std::uint32_t i = at_;
  const MotionState from = state_before(i);
  const Segment s = make_segment(i, from);
  for (int a = 0; a < limits_->axes; ++a) {
    const Int128 off =
        s.end.axis[index(a)].position_q64 - stepper::middle_of_step(target(i).steps[index(a)]);
    stages_[i].chosen.off_q64[index(a)] = off.to_int64();
  }
  const bool in = inside(s, from);
  if (!in || !can_stop(s)) return stop_at(i, in);
  if (++at_ < request_->count) return;
  result_ = Result::ok;
  phase_ = Phase::over;
}

/// Makes the end of a segment that fails its check a full stop, its start too if it leaves the work
/// space, and plans the window again: at most once per point.
void PathPlanner::stop_at(std::uint32_t i, bool inside) {
  Stage& stage = stages_[i];
  const bool had_rest =
      stage.corner_q32 == 0 && (inside || i == 0 || stages_[i - 1].corner_q32 == 0);
  stage.corner_q32 = 0;
  if (!inside && i > 0) stages_[i - 1].corner_q32 = 0;
  failed_ = i;
  phase_ = Phase::over;
  if (!had_rest) start_over();
}

bool PathPlanner::inside(const Segment& s, const MotionState& from) const {
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const AxisProfile& profile = s.axis[index(a)];
    if (!within_limits(profile, axis.speed_q62, axis.accel_q62)) return false;
    if (!keeps_jerk(profile, axis.jerk_q78)) return false;
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

/// True if the axes can stop inside the work space from the end of a segment, and from any tick of
/// it. A profile of n ticks may peak 1.02/n above the acceleration of brakes (limits.cpp): a brake
/// within it then ends v^2/2A 1.02/n further, v/A being less than n ticks, so by at most the
/// distance of half a tick.
bool PathPlanner::can_stop(const Segment& s) const {
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const AxisProfile& profile = s.axis[index(a)];
    const AxisState& end = s.end.axis[index(a)];
    if (end.speed_q62 == 0) continue;
    const std::int64_t cruise = abs64(profile.cruise_speed_q62());
    std::int64_t fastest = abs64(profile.speed_q62);
    if (cruise > fastest) fastest = cruise;
    // Half the time at the speed, rounded up.
    const std::int64_t ticks = std::int64_t{brake_ticks(end.speed_q62, AxisBrake(axis))} + 1;
    const Int128 stop = end.position_q64 + (Int128::product(end.speed_q62, ticks) << 1);
    const Int128 room = Int128(fastest) << 1;
    if ((stop - room).hi() < axis.min_steps || (stop + room).hi() > axis.max_steps) return false;
  }
  return true;
}

std::int64_t PathPlanner::start_speed_q32(std::uint32_t i) const {
  if (i == 0) return start_q32_;
  return min_of(scaled(stages_[i - 1].chosen.speed_q32, stages_[i].from_previous),
                stages_[i].line.speed_q32);
}

/// The phases of a line, for an axis that moves forwards: as long as its pulses, or where jerk is
/// not limited the quietest.
AxisProfile PathPlanner::phases(std::uint32_t i, Int128 way, std::int64_t v0, std::int64_t v1,
                                std::int64_t speed) const {
  const Stage& stage = stages_[i];
  const auto beats = stage.chosen.beats;
  const std::uint32_t ticks = static_cast<std::uint32_t>(beats) * limits_->beat_ticks;
  if (stage.has_pulses()) {
    const PulseLengths pulses = pulse_lengths(stage.line, beats, stage.chosen.split);
    AxisProfile p;
    p.lead_ticks = static_cast<std::uint32_t>(mul_q32(pulses.lead_q32, limits_->beat_ticks));
    p.tail_ticks = static_cast<std::uint32_t>(mul_q32(pulses.tail_q32, limits_->beat_ticks));
    // Halves of an odd number leave a tick, too short for a phase.
    if (p.lead_ticks + p.tail_ticks + 1 == ticks) ++p.tail_ticks;
    p.cruise_ticks = ticks - p.lead_ticks - p.tail_ticks;
    return p;
  }
  // In a frame that moves at half the highest speed, so that it never goes back.
  const std::int64_t half = speed / 2;
  return make_profile(way - Int128::product(half, ticks), v0 - half, v1 - half, ticks, half);
}

Segment PathPlanner::make_segment(std::uint32_t i, const MotionState& from) const {
  const Stage& stage = stages_[i];
  const wire::Target& to = target(i);
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
  // The phases of the longest axis are used for all.
  AxisProfile all;
  if (path.none) {
    all.lead_ticks = s.ticks / 2;
    all.tail_ticks = s.ticks - all.lead_ticks;
  } else {
    const PerAxis<std::int64_t> most =
        axis_speeds_q62(path, stage.line.speed_q32, limits_->beat_ticks);
    const Int128 forth = path.way[index(longest)] < 0 ? -way[index(longest)] : way[index(longest)];
    all = phases(i, forth, abs64(v0[index(longest)]), abs64(v1[index(longest)]),
                 abs64(most[index(longest)]));
  }
  for (int a = 0; a < limits_->axes; ++a)
    s.axis[index(a)] = make_phases(way[index(a)], v0[index(a)], v1[index(a)], all.lead_ticks,
                                   all.cruise_ticks, all.tail_ticks);
  if (stage.has_pulses()) make_pulses(s.axis, v1, *limits_);
  for (int a = 0; a < limits_->axes; ++a)
    s.end.axis[index(a)] = {
        from.axis[index(a)].position_q64 + (stepper::displacement_q62(s.axis[index(a)]) << 2),
        v1[index(a)]};
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
  PerAxis<std::int64_t> after{};
  if (i + 1 < request_->count)
    after = axis_speeds_q62(line(i + 1), start_speed_q32(i + 1), limits_->beat_ticks);
  std::int64_t min_q32 = one_q32 / 4;
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int64_t one = abs64(before[index(a)]), other = abs64(after[index(a)]);
    const std::int64_t per_beat_q32 =
        (Int128::product(one > other ? one : other, limits_->beat_ticks) >> 30).to_int64();
    const std::int64_t v = axis.displacement_q32(per_beat_q32);
    const std::int64_t root = sqrt_down_q32(mul_q32(v, v) + 2 * axis.shot_way_q32);
    min_q32 = min_of(min_q32, root > v ? root - v : 0);
  }
  return static_cast<std::uint32_t>((min_q32 * limits_->beat_ticks) >> 32);
}

}  // namespace lamplock::motion
