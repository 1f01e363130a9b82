// Checks that hold for every plan, fast enough for a million chains.
//
// In:  a chain and its plan, or a window from the planner. Out: the first fault. Phases are checked
// at their ends and by excursions, which is exact; some segments tick by tick.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <tuple>

#include "firmware/motion/profile/pulse.hpp"
#include "tests/motion/chain.hpp"
#include "tests/motion/jerk_watch.hpp"
#include "tests/motion/tick_sum.hpp"

namespace lamplock::test {

/// The first fault of a plan and its place; `what` is null if there is none.
struct Fault {
  const char* what = nullptr;
  std::uint32_t point = 0;
  int axis = -1;

  explicit operator bool() const { return what != nullptr; }
  friend bool operator==(const Fault&, const Fault&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Fault& fault) {
    if (!fault) return out << "nothing wrong";
    out << fault.what << " in the move to point " << fault.point;
    return fault.axis < 0 ? out : out << ", axis " << fault.axis;
  }
};

/// Whether the step displayed at a position is inside the work space.
inline bool in_work_space(const motion::AxisLimits& axis, Int128 position_q64) {
  return axis.min_steps <= position_q64.hi() && position_q64.hi() <= axis.max_steps;
}

/// Both ends of an excursion from a position.
inline bool in_work_space(const motion::AxisLimits& axis, Int128 from_q64,
                          const motion::Excursion& way) {
  return in_work_space(axis, from_q64 + (way.low_q62 << 2)) &&
         in_work_space(axis, from_q64 + (way.high_q62 << 2));
}

/// Accelerations of an axis are whole multiples of this. Along a path all axes have the same
/// phases.
inline std::int64_t accel_unit(const motion::Limits& limits, int a, bool path) {
  const bool pulses = path ? limits.jerk_limited() : limits.axis[index(a)].jerk_q78 != 0;
  return pulses ? stepper::pulse_accel_unit : 2;
}

/// Continuity: a segment starts where, when and, except on a path, as fast as the preceding one
/// ended; whole beats.
inline Fault join_fault(const motion::Limits& limits, const stepper::MotionState& from,
                        const stepper::Segment& s, std::int32_t beats, bool path = false) {
  if (s.start_tick != from.tick) return {"does not start where the last one ended", s.point};
  if (beats < 1 || s.ticks != static_cast<std::uint32_t>(beats) * limits.beat_ticks ||
      s.end.tick != s.start_tick + s.ticks)
    return {"not these whole beats", s.point};
  for (int a = 0; a < limits.axes; ++a) {
    const stepper::AxisProfile& p = s.axis[index(a)];
    const stepper::AxisState &begin = from.axis[index(a)], &end = s.end.axis[index(a)];
    if (p.ticks() != s.ticks) return {"phases do not add up", s.point, a};
    if (!path && p.speed_q62 != begin.speed_q62) return {"speed jumps", s.point, a};
    const auto phases = [](const stepper::AxisProfile& of) {
      return std::tuple(of.lead_ticks, of.cruise_ticks, of.lead_ramp, of.tail_ramp);
    };
    if (path && phases(p) != phases(s.axis[0])) return {"other phases than axis 0", s.point, a};
    if (end.position_q64 != begin.position_q64 + (stepper::displacement_q62(p) << 2))
      return {"end is not where the phases lead", s.point, a};
    if (abs64(p.end_speed_q62() - end.speed_q62) >
        accel_unit(limits, a, path) * static_cast<std::int64_t>(p.tail_ticks))
      return {"end speed is not that of the phases", s.point, a};
  }
  return {};
}

/// The end of a point: the middle of its step on every axis, the shot as ordered.
inline Fault point_fault(const Chain& chain, const stepper::Segment& s, std::uint32_t point,
                         bool path = false) {
  const wire::Target& target = chain.targets[point];
  if (!s.ends_point || s.point != point) return {"another point", point};
  if (s.shot.present != (target.shots != 0)) return {"shot not as ordered", point};
  if (s.shot.present &&
      (s.shot.half_window_ticks < 1 || s.shot.half_window_ticks > chain.limits.beat_ticks / 4))
    return {"window of the shot", point};
  // 1e-6 step, plus the effect of even accelerations over very long segments.
  const double n = s.ticks;
  for (int a = 0; a < chain.limits.axes; ++a) {
    const auto unit = static_cast<double>(accel_unit(chain.limits, a, path));
    const double near = 1e-6 + unit * n * n / 4.6e18;
    const Int128 at = s.end.axis[index(a)].position_q64;
    const std::int32_t step = target.steps[index(a)];
    if (at.hi() != step) return {"not on its step", point, a};
    const auto off_q64 = static_cast<double>(native(at - stepper::middle_of_step(step)));
    if (!(std::fabs(std::ldexp(off_q64, -64)) < near))
      return {"not in the middle of its step", point, a};
  }
  return {};
}

/// Limits at the ends of the phases and by excursions.
inline Fault limits_fault(const motion::Limits& limits, const stepper::MotionState& from,
                          const stepper::Segment& s) {
  for (int a = 0; a < limits.axes; ++a) {
    const motion::AxisLimits& axis = limits.axis[index(a)];
    const stepper::AxisProfile& p = s.axis[index(a)];
    if (abs64(p.speed_q62) > axis.speed_q62 || abs64(p.cruise_speed_q62()) > axis.speed_q62 ||
        abs64(p.end_speed_q62()) > axis.speed_q62)
      return {"too fast", s.point, a};
    if (abs64(p.lead_accel_q62) > axis.accel_q62 || abs64(p.tail_accel_q62) > axis.accel_q62)
      return {"accelerates too hard", s.point, a};
    if (!motion::keeps_jerk(p, axis.jerk_q78)) return {"jerks", s.point, a};
    if (!in_work_space(axis, from.axis[index(a)].position_q64, motion::excursion(p)))
      return {"leaves the work space", s.point, a};
  }
  return {};
}

/// The same at every tick.
inline Fault tick_fault(const motion::Limits& limits, const stepper::MotionState& from,
                        const stepper::Segment& s) {
  for (int a = 0; a < limits.axes; ++a) {
    const motion::AxisLimits& axis = limits.axis[index(a)];
    const Int128 start = from.axis[index(a)].position_q64;
    const TickSum sum = sum_ticks(s.axis[index(a)]);
    if (sum.max_speed_q62 > axis.speed_q62) return {"too fast at a tick", s.point, a};
    if (sum.max_accel_q62 > axis.accel_q62) return {"accelerates too hard at a tick", s.point, a};
    if (!in_work_space(axis, start + (to_int128(sum.min_q62) << 2)) ||
        !in_work_space(axis, start + (to_int128(sum.max_q62) << 2)))
      return {"leaves the work space at a tick", s.point, a};
    if (s.end.axis[index(a)].position_q64 != start + (to_int128(sum.end_q62) << 2))
      return {"end is not where the ticks lead", s.point, a};
  }
  return {};
}

/// The same at every tick of a plan, up to `most` ticks; the jerk is watched over all segments.
inline Fault ticks_fault(const motion::Limits& limits,
                         const std::vector<stepper::Segment>& segments, long most) {
  std::vector<JerkWatch> watches;
  for (const motion::AxisLimits& axis : limits.axis) watches.emplace_back(axis);
  stepper::MotionState from = rest_at_zero();
  for (const stepper::Segment& s : segments) {
    if ((most -= s.ticks) < 0) break;
    if (const Fault fault = tick_fault(limits, from, s)) return fault;
    for (int a = 0; a < limits.axes && limits.jerk_limited(); ++a) {
      JerkWatch& watch = watches[index(a)];
      watch.allow_stairs(s.axis[index(a)]);
      for_each_tick(s.axis[index(a)],
                    [&](Native, std::int64_t, std::int64_t accel) { watch.tick(accel); });
      if (watch.broken()) return {"jerks at a tick", s.point, a};
    }
    from = s.end;
  }
  return {};
}

/// The stored tail: a brake of every axis from the end of a segment to rest, inside all limits.
inline Fault brake_fault(const motion::Limits& limits, const stepper::Segment& s) {
  if (s.end.at_rest()) return {};
  const stepper::Segment brake = motion::make_brake(s.end, limits);
  if (!brake.end.at_rest()) return {"a brake does not end at rest", s.point};
  if (const Fault fault = limits_fault(limits, s.end, brake))
    return {fault.what, s.point, fault.axis};
  return {};
}

/// All checks of one segment.
inline Fault segment_fault(const Chain& chain, const stepper::MotionState& from,
                           const stepper::Segment& s, std::int32_t beats, std::uint32_t point) {
  if (const Fault fault = join_fault(chain.limits, from, s, beats)) return fault;
  if (const Fault fault = point_fault(chain, s, point)) return fault;
  if (const Fault fault = limits_fault(chain.limits, from, s)) return fault;
  const std::int32_t ordered = chain.targets[point].beats;
  if (ordered != 0 && beats != ordered) return {"not the beats that were ordered", point};
  return {};
}

/// Checks a whole plan, rest to rest. Every fifth segment is checked tick by tick while
/// `ticks_to_sum` lasts.
inline Fault plan_fault(const Chain& chain, const ChainPlan& plan, long& ticks_to_sum) {
  if (plan.result != Result::ok) return {"no plan", static_cast<std::uint32_t>(plan.beats.size())};
  if (plan.segments.size() != chain.targets.size()) return {"points are missing"};
  stepper::MotionState from = rest_at_zero();
  for (std::uint32_t i = 0; i < plan.segments.size(); ++i) {
    const stepper::Segment& s = plan.segments[i];
    if (const Fault fault = segment_fault(chain, from, s, plan.beats[i], i)) return fault;
    if (ticks_to_sum > 0 && i % 5 == 0) {
      ticks_to_sum -= s.ticks;
      if (const Fault fault = tick_fault(chain.limits, from, s)) return fault;
    }
    from = s.end;
  }
  if (!from.at_rest()) return {"does not end at rest"};
  return {};
}

/// Checks a committed window: from the end of every segment a brake leads to rest inside all
/// limits; the last point of a job is at rest.
inline Fault window_fault(const Chain& chain, const motion::Planner& planner,
                          const motion::PlanRequest& request) {
  stepper::MotionState from = request.start;
  const std::uint32_t commits = request.commits();
  for (std::uint32_t i = 0; i < commits; ++i) {
    const stepper::Segment& s = planner.segment(i);
    if (const Fault fault = segment_fault(chain, from, s, planner.beats(i), request.points[i]))
      return fault;
    if (const Fault fault = brake_fault(chain.limits, s)) return fault;
    from = s.end;
  }
  if (request.rest_at_end && commits == request.count && !from.at_rest())
    return {"a job does not end at rest", request.points[commits - 1]};
  return {};
}

/// Plans a chain: the first fault of a window or of the whole plan, without checking ticks.
inline Fault chain_fault(const Chain& chain, motion::Planner& planner, ChainPlan& plan) {
  Fault fault;
  plan = plan_chain(chain, planner, [&](const motion::Planner& p, const motion::PlanRequest& r) {
    if (!fault) fault = window_fault(chain, p, r);
  });
  long no_ticks = 0;
  return fault ? fault : plan_fault(chain, plan, no_ticks);
}

}  // namespace lamplock::test
