#include "firmware/motion/planner.hpp"

#include "firmware/motion/profile.hpp"

namespace lamplock::motion {
namespace {

/// Candidate times tried per label, and how they are spaced once they get long.
constexpr int candidates_per_label = 5;
constexpr std::int32_t candidate_spacing = 4;
/// Beats searched beyond the least possible before a label is given up.
constexpr std::int32_t max_extra_beats = 64;
/// Ticks of a segment are kept in 31 bits.
constexpr std::uint32_t longest_segment_ticks = 0x7fffffff;

std::int64_t width_q32(const PerAxis<SpeedInterval>& box) {
  std::int64_t sum = 0;
  for (const SpeedInterval& side : box) sum += side.hi_q32 - side.lo_q32;
  return sum;
}

bool covers(const PerAxis<SpeedInterval>& outer, const PerAxis<SpeedInterval>& inner) {
  for (int a = 0; a < max_axes; ++a)
    if (!outer[index(a)].contains(inner[index(a)])) return false;
  return true;
}

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

/// More steps than the profile can go in any direction: all the time at its highest speed.
std::int64_t most_steps(const AxisProfile& p) {
  std::int64_t speed_q62 = abs64(p.speed_q62);
  for (const std::int64_t other : {abs64(p.cruise_speed_q62()), abs64(p.end_speed_q62())})
    if (other > speed_q62) speed_q62 = other;
  const auto speed_q30 = static_cast<std::uint32_t>(speed_q62 >> 32) + 1;
  return static_cast<std::int64_t>(wide_product(speed_q30, p.ticks()) >> 30) + 1;
}

}  // namespace

Result Planner::plan(const PlanRequest& request, std::uint32_t& failed) {
  limits_ = request.limits;
  least_beats_ = request.least_beats;
  const std::uint32_t most = longest_segment_ticks / limits_->beat_ticks;
  most_beats_ = most < max_beats_per_point ? static_cast<std::int32_t>(most) : max_beats_per_point;
  // From any start speed, 2 V/A beats more than at full speed are enough to brake and come back.
  extra_beats_ = max_extra_beats;
  for (int a = 0; a < limits_->axes; ++a)
    extra_beats_ += 2 * (limits_->axis[index(a)].speed_q32 >> 32);
  if (const Result r = set_up(request, failed); r != Result::ok) return r;
  // Every round that fails turns at least one more point into a rest: at most `count` rounds.
  for (std::uint32_t round = 0; round <= request.count; ++round) {
    if (const Result r = search(request, failed); r != Result::ok) return r;
    choose_speeds(request);
    bool again = false;
    if (make_segments(request, again)) return Result::ok;
    if (!again) break;
  }
  failed = 0;
  return Result::unreachable;
}

Result Planner::set_up(const PlanRequest& request, std::uint32_t& failed) {
  start_ = Label{};
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int64_t per_beat_q32 =
        (Int128::product(request.start.axis[index(a)].speed_q62, limits_->beat_ticks) >> 30)
            .to_int64();
    const std::int64_t v = axis.displacement_q32(per_beat_q32);
    // The speed was made from a normalised one: allow for the rounding of both conversions.
    const std::int64_t slack = v == 0 ? 0 : 64 + (abs64(v) >> 28);
    start_.box[index(a)] = {v - slack, v + slack};
  }
  for (std::uint32_t i = 0; i < request.count; ++i) {
    Stage& stage = stages_[i];
    const Target& target = request.queue->at(request.points[i]);
    stage.rest = request.mode == JoinMode::start_stop || i + 1 == request.count;
    const Target* previous = i == 0 ? nullptr : &request.queue->at(request.points[i - 1]);
    for (int a = 0; a < limits_->axes; ++a) {
      const std::int64_t way =
          i == 0 ? way_q32(request.start.axis[index(a)].position_q64, target.steps[index(a)])
                 : (std::int64_t{target.steps[index(a)]} - previous->steps[index(a)]) * one_q32;
      const std::int64_t q = limits_->axis[index(a)].displacement_q32(way);
      if (abs64(q) > max_displacement_q32) {
        failed = i;
        return Result::unreachable;
      }
      stage.displacement_q32[index(a)] = q;
    }
    stage.first_beats = first_beats(stage);
  }
  return Result::ok;
}

Result Planner::search(const PlanRequest& request, std::uint32_t& failed) {
  for (std::uint32_t i = 0; i < request.count; ++i) {
    if (!extend(request, i)) {
      failed = i;
      return Result::unreachable;
    }
  }
  // The last stage is a rest: one label, the one with the fewest beats.
  std::uint8_t label = 0;
  for (std::uint32_t i = request.count; i-- > 0;) {
    beats_[i] = stages_[i].labels[label].beats;
    const std::uint8_t parent = stages_[i].labels[label].parent;
    if (label != 0) stages_[i].labels[0] = stages_[i].labels[label];  // the chosen one in front
    label = parent;
  }
  return Result::ok;
}

bool Planner::extend(const PlanRequest& request, std::uint32_t i) {
  Stage& stage = stages_[i];
  const Stage* next = i + 1 < request.count ? &stages_[i + 1] : nullptr;
  const Target& target = request.queue->at(request.points[i]);
  const std::int32_t fixed = target.beats;
  const std::size_t parents = i == 0 ? 1 : stages_[i - 1].count;
  stage.count = 0;
  for (std::size_t p = 0; p < parents; ++p) {
    const Label& from = i == 0 ? start_ : stages_[i - 1].labels[p];
    Label label;
    label.parent = static_cast<std::uint8_t>(p);
    if (fixed != 0) {
      const bool slow_enough = target.shots == 0 || fixed >= least_beats_;
      if (slow_enough && step(from, stage, fixed, label)) keep(stage, label, next);
      continue;
    }
    std::int32_t beats = i == 0 ? fewest_beats(from, stage) : from.next;
    for (int tries = 0; beats != 0 && tries < candidates_per_label; ++tries) {
      if (too_late(stage, from.total + beats, next)) break;
      if (step(from, stage, beats, label)) {
        keep(stage, label, next);
        if (stage.rest || (tries >= 2 && at_rest_possible(label))) break;
      }
      beats += 1 + (tries < 2 ? 0 : beats / candidate_spacing);
    }
  }
  return stage.count != 0;
}

bool Planner::step(const Label& from, const Stage& to, std::int32_t beats, Label& result) const {
  if (beats > most_beats_) return false;
  for (int a = 0; a < limits_->axes; ++a) {
    SpeedInterval& side = result.box[index(a)];
    if (!reach(from.box[index(a)], to.displacement_q32[index(a)], beats,
               limits_->axis[index(a)].speed_q32, side))
      return false;
    if (to.rest) {
      if (!side.contains(0)) return false;
      side = {0, 0};
    }
  }
  result.beats = beats;
  result.total = from.total + beats;
  return true;
}

std::int32_t Planner::first_beats(const Stage& to) const {
  std::int32_t first = least_beats_;
  for (int a = 0; a < limits_->axes; ++a) {
    const std::int64_t limit = limits_->axis[index(a)].speed_q32;
    const std::int64_t beats = (abs64(to.displacement_q32[index(a)]) + limit - 1) / limit;
    if (beats > most_beats_) return 0;
    if (beats > first) first = static_cast<std::int32_t>(beats);
  }
  return first;
}

std::int32_t Planner::fewest_beats(const Label& from, const Stage& to) const {
  if (to.first_beats == 0) return 0;
  std::int64_t last = to.first_beats + extra_beats_;
  if (last > most_beats_) last = most_beats_;
  for (std::int32_t beats = to.first_beats; beats <= last; ++beats)
    if (can_step(from, to, beats)) return beats;
  return 0;
}

bool Planner::can_step(const Label& from, const Stage& to, std::int32_t beats) const {
  bool clear = !to.rest;
  for (int a = 0; a < limits_->axes; ++a) {
    const Reachable axis = reachable(from.box[index(a)], to.displacement_q32[index(a)], beats,
                                     limits_->axis[index(a)].speed_q32);
    if (axis == Reachable::no) return false;
    if (axis == Reachable::unclear) clear = false;
  }
  Label probe;
  return clear || step(from, to, beats, probe);
}

bool Planner::at_rest_possible(const Label& label) const {
  for (int a = 0; a < limits_->axes; ++a)
    if (!label.box[index(a)].contains(0)) return false;
  return true;
}

/// True if a label with this total, whatever its speeds, can neither push out nor outrank one of
/// those kept; then neither can one with more beats.
bool Planner::too_late(const Stage& stage, std::int32_t total, const Stage* next) {
  if (stage.count < beam_width) return false;
  for (const Label& kept : stage.labels)
    if (total <= kept.total) return false;
  const Label& worst = stage.labels[beam_width - 1];
  return total + (next != nullptr ? next->first_beats : 0) > worst.total + worst.next;
}

void Planner::keep(Stage& stage, Label& label, const Stage* next) {
  for (std::size_t i = 0; i < stage.count; ++i) {
    const Label& other = stage.labels[i];
    if (other.total <= label.total && covers(other.box, label.box)) return;
  }
  label.next = next != nullptr ? fewest_beats(label, *next) : 0;
  if (next != nullptr && label.next == 0) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < stage.count; ++i) {
    const Label& other = stage.labels[i];
    if (label.total <= other.total && covers(label.box, other.box)) continue;
    if (kept != i) stage.labels[kept] = other;
    ++kept;
  }
  stage.count = kept;
  const auto better = [](const Label& a, const Label& b) {
    const std::int32_t ra = a.total + a.next, rb = b.total + b.next;
    return ra != rb ? ra < rb : width_q32(a.box) > width_q32(b.box);
  };
  std::size_t place = stage.count;
  while (place > 0 && better(label, stage.labels[place - 1])) --place;
  if (place >= beam_width) return;
  if (stage.count < beam_width) ++stage.count;
  for (std::size_t i = stage.count - 1; i > place; --i) stage.labels[i] = stage.labels[i - 1];
  stage.labels[place] = label;
}

void Planner::choose_speeds(const PlanRequest& request) {
  speed_q32_[request.count - 1] = {};
  for (std::uint32_t i = request.count - 1; i-- > 0;) {
    for (int a = 0; a < limits_->axes; ++a) {
      // reach() is symmetric: from the end speeds backwards it gives the start speeds. Its bounds
      // are rounded inwards, so a speed on a bound needs a hair of width not to be lost.
      const std::int64_t behind = speed_q32_[i + 1][index(a)];
      const std::int64_t slack = 8 + 4 * beats_[i + 1] + (abs64(behind) >> 28);
      const SpeedInterval& box = stages_[i].labels[0].box[index(a)];
      SpeedInterval can = box;
      reach({behind - slack, behind + slack}, stages_[i + 1].displacement_q32[index(a)],
            beats_[i + 1], limits_->axis[index(a)].speed_q32, can);
      const std::int64_t nearest = can.lo_q32 > box.hi_q32 ? box.hi_q32 : box.lo_q32;
      const std::int64_t lo = can.lo_q32 > box.lo_q32 ? can.lo_q32 : box.lo_q32;
      const std::int64_t hi = can.hi_q32 < box.hi_q32 ? can.hi_q32 : box.hi_q32;
      const SpeedInterval both = lo <= hi ? SpeedInterval{lo, hi} : SpeedInterval{nearest, nearest};
      speed_q32_[i][index(a)] = both.clamp(wanted_speed_q32(request, i, a));
    }
  }
}

std::int64_t Planner::wanted_speed_q32(const PlanRequest& request, std::uint32_t i, int a) const {
  if (stages_[i].rest || i + 1 >= request.count) return 0;
  return (stages_[i].displacement_q32[index(a)] + stages_[i + 1].displacement_q32[index(a)]) /
         (beats_[i] + beats_[i + 1]);
}

bool Planner::make_segments(const PlanRequest& request, bool& again) {
  MotionState from = request.start;
  for (std::uint32_t i = 0; i < request.count; ++i) {
    make_segment(request, i, from);
    if (!inside(i, from)) {
      const bool all_rest = stages_[i].rest && (i == 0 || stages_[i - 1].rest);
      stages_[i].rest = true;
      if (i > 0) stages_[i - 1].rest = true;
      again = !all_rest;
      return false;
    }
    from = segments_[i].end;
  }
  return true;
}

void Planner::make_segment(const PlanRequest& request, std::uint32_t i, const MotionState& from) {
  const Target& target = request.queue->at(request.points[i]);
  Segment& s = segments_[i];
  s = Segment{};
  s.start_tick = from.tick;
  s.ticks = static_cast<std::uint32_t>(beats_[i]) * limits_->beat_ticks;
  s.ends_point = true;
  s.point = request.points[i];
  s.end.tick = s.end_tick();
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisState& axis = from.axis[index(a)];
    const Int128 way = (stepper::middle_of_step(target.steps[index(a)]) - axis.position_q64) >> 2;
    const std::int64_t end_speed = limits_->speed_q62(a, speed_q32_[i][index(a)]);
    s.axis[index(a)] = make_profile(way, axis.speed_q62, end_speed, s.ticks,
                                    limits_->axis[index(a)].plan_speed_q62);
    s.end.axis[index(a)] = {axis.position_q64 + (stepper::displacement_q62(s.axis[index(a)]) << 2),
                            end_speed};
  }
  if (target.shots != 0) s.shot = {true, shot_window_ticks(i), target.channel, target.energy};
}

bool Planner::inside(std::uint32_t i, const MotionState& from) const {
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const AxisProfile& profile = segments_[i].axis[index(a)];
    if (!within_limits(profile, axis.speed_q62, axis.accel_q62)) return false;
    const Int128 start = from.axis[index(a)].position_q64;
    const std::int64_t end = segments_[i].end.axis[index(a)].position_q64.hi();
    const std::int64_t beyond = reverses(profile) ? most_steps(profile) : 0;
    const std::int64_t low = start.hi() < end ? start.hi() : end;
    const std::int64_t high = start.hi() < end ? end : start.hi();
    if (low - beyond >= axis.min_steps && high + beyond <= axis.max_steps) continue;
    if (beyond == 0) return false;
    const Excursion e = excursion(profile);
    if ((start + (e.low_q62 << 2)).hi() < axis.min_steps) return false;
    if ((start + (e.high_q62 << 2)).hi() > axis.max_steps) return false;
  }
  return true;
}

std::uint32_t Planner::shot_window_ticks(std::uint32_t i) const {
  // |speed| <= v + A t on both sides of the point: v t + A t^2 / 2 = tolerance.
  // Never more than a quarter beat: an edge that far off belongs to no beat.
  std::int64_t least_q32 = one_q32 / 4;
  for (int a = 0; a < limits_->axes; ++a) {
    const AxisLimits& axis = limits_->axis[index(a)];
    const std::int64_t v = abs64(speed_q32_[i][index(a)]);
    const std::int64_t root = sqrt_down_q32(mul_q32(v, v) + 2 * axis.shot_way_q32);
    const std::int64_t t = root > v ? root - v : 0;
    if (t < least_q32) least_q32 = t;
  }
  return static_cast<std::uint32_t>((least_q32 * limits_->beat_ticks) >> 32);
}

}  // namespace lamplock::motion
