#include "firmware/motion/line_segment.hpp"

#include "firmware/motion/profile.hpp"
#include "firmware/motion/pulse.hpp"

namespace lamplock::motion {
namespace {

/// Less than this is no way for an axis but rounding: 2^-21 step, Q62.
constexpr std::int64_t no_way_q62 = one_q62 >> 21;

std::uint64_t magnitude(std::int64_t v) { return static_cast<std::uint64_t>(abs64(v)); }
std::int64_t even(std::int64_t accel_q62) { return accel_q62 & ~std::int64_t{1}; }

/// Speed of an axis, `per_tick` being the part of the line in a tick.
std::int64_t axis_speed_q62(std::int64_t steps, Real per_tick) {
  const std::int64_t speed = (Real(magnitude(steps)) * per_tick).fixed(62);
  return steps < 0 ? -speed : speed;
}

Int128 way_left_q62(const stepper::MotionState& at, const StepPosition& target, std::size_t a) {
  return (stepper::middle_of_step(target[a]) - at.axis[a].position_q64) >> 2;
}

/// Speeds of an axis at the ends of phases.
struct AxisSpeeds {
  std::int64_t start_q62, cruise_q62, end_q62;
};

/// The speed between the phases so that the way comes out: solved for what is missing, which is
/// little.
void fit_way(AxisSpeeds& v, Int128 way, const LineRun& run) {
  const std::uint32_t parts = run.lead_ticks + 2 * run.cruise_ticks + run.tail_ticks;
  Int128 missing = (way << 1) - Int128::times(v.cruise_q62, parts);
  if (run.lead_ticks != 0) missing = missing - Int128::times(v.start_q62, run.lead_ticks);
  if (run.tail_ticks != 0) missing = missing - Int128::times(v.end_q62, run.tail_ticks);
  v.cruise_q62 += missing.to_int64() / static_cast<std::int64_t>(parts);
  if (run.lead_ticks == 0) v.start_q62 = v.cruise_q62;
  if (run.tail_ticks == 0) v.end_q62 = v.cruise_q62;
}

AxisProfile make_axis(const AxisSpeeds& v, const LineRun& run) {
  AxisProfile p;
  p.speed_q62 = v.start_q62;
  p.lead_ticks = run.lead_ticks;
  p.cruise_ticks = run.cruise_ticks;
  p.tail_ticks = run.tail_ticks;
  if (run.lead_ticks != 0)
    p.lead_accel_q62 =
        even((v.cruise_q62 - v.start_q62) / static_cast<std::int64_t>(run.lead_ticks));
  if (run.tail_ticks != 0)
    p.tail_accel_q62 =
        even((v.end_q62 - p.cruise_speed_q62()) / static_cast<std::int64_t>(run.tail_ticks));
  set_turns(p);
  return p;
}

}  // namespace

Real length_left(const LineWay& way, Real length, int longest, const stepper::MotionState& at) {
  const std::size_t a = index(longest);
  Int128 left = stepper::middle_of_step(way.target[a]) - at.axis[a].position_q64;
  if (way.steps[a] < 0) left = -left;
  if (left.negative()) return {};
  const auto hi = static_cast<std::uint64_t>(left.hi());
  const Real steps = hi == 0 ? Real(left.lo(), -64) : Real(hi << 32 | left.lo() >> 32, -32);
  return steps * length / Real(magnitude(way.steps[a]));
}

stepper::Segment make_segment(const stepper::MotionState& from, const LineWay& way,
                              const LineRun& run, const Limits& limits, bool pulses) {
  stepper::Segment s;
  s.start_tick = from.tick;
  s.ticks = run.ticks();
  s.end = from;
  s.end.tick = s.end_tick();
  const Real start = run.start * way.per_length, cruise = run.cruise * way.per_length,
             end = run.end * way.per_length;
  PerAxis<std::int64_t> ends{};
  for (std::size_t a = 0; a < max_axes; ++a) {
    const std::int64_t steps = way.steps[a];
    s.axis[a].cruise_ticks = s.ticks;
    if (steps == 0) {
      if (pulses) s.axis[a] = make_axis({}, run);
      continue;
    }
    AxisSpeeds v{axis_speed_q62(steps, start), axis_speed_q62(steps, cruise),
                 axis_speed_q62(steps, end)};
    if (run.whole && !is_zero(run.cruise)) fit_way(v, way_left_q62(from, way.target, a), run);
    s.axis[a] = make_axis(v, run);
    ends[a] = v.end_q62;
  }
  if (pulses) make_pulses(s.axis, ends, limits);
  for (std::size_t a = 0; a < max_axes; ++a)
    s.end.axis[a] = {from.axis[a].position_q64 + (stepper::displacement_q62(s.axis[a]) << 2),
                     ends[a]};
  return s;
}

stepper::Segment make_settling(const stepper::MotionState& from, std::uint32_t ticks) {
  stepper::Segment s;
  s.start_tick = from.tick;
  s.ticks = ticks;
  s.end = from;
  s.end.tick = s.end_tick();
  for (std::size_t a = 0; a < max_axes; ++a) {
    const StepPosition here{from.axis[0].step(), from.axis[1].step(), from.axis[2].step(),
                            from.axis[3].step()};
    const Int128 way = way_left_q62(from, here, a);
    s.axis[a].cruise_ticks = ticks;
    if (way < Int128(no_way_q62) && Int128(-no_way_q62) < way) continue;
    s.axis[a] = make_phases(way, 0, 0, ticks / 2, 0, ticks - ticks / 2);
    s.end.axis[a].position_q64 =
        from.axis[a].position_q64 + (stepper::displacement_q62(s.axis[a]) << 2);
  }
  return s;
}

}  // namespace lamplock::motion
