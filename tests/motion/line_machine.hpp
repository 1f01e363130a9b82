// A machine that runs lines: random machines and paths, the planner's output, and checks of every
// segment.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "firmware/motion/line/planner.hpp"
#include "firmware/motion/profile/profile.hpp"
#include "firmware/motion/profile/pulse.hpp"
#include "host/bench/machine.hpp"
#include "shared/settings_table.hpp"
#include "tests/motion/jerk_watch.hpp"
#include "tests/motion/tick_sum.hpp"
#include "tests/native_int128.hpp"

namespace lamplock::test {

using motion::LineSegment;
using motion::LineTarget;
using LineVector = std::array<double, max_axes>;

inline double line_q62(std::int64_t v) { return std::ldexp(static_cast<double>(v), -62); }

/// Sets a place `steps` steps from zero along an axis, in the planner's format.
inline void put_place(motion::LinePlace& place, int axis, double steps) {
  const double step = std::round(steps);
  const auto off = static_cast<int>(std::lround((steps - step) * (1 << motion::place_bits)));
  place.steps[index(axis)] = static_cast<std::int32_t>(step);
  place.off_q8[index(axis)] =
      static_cast<std::int8_t>(std::clamp(off, -motion::max_off_q8, motion::max_off_q8));
}
inline double steps_at(const motion::LinePlace& place, std::size_t axis) {
  return place.steps[axis] + std::ldexp(place.off_q8[axis], -motion::place_bits);
}

/// Settings of a machine in the units of the user, per axis.
struct LineMachine {
  int axes = 3;
  LineVector steps_mm{200, 200, 200, 200}, speed_mm_s{1000, 1000, 1000, 1000},
      accel_mm_s2{4000, 4000, 4000, 4000}, jerk_m_s3{}, jump_mm_s{};
  double deviation_mm = 0.01;

  /// Any value works; the limits are computed with this one.
  static constexpr double nominal_hz = 100;

  double coarsest() const {
    double least = steps_mm[0];
    for (int a = 1; a < axes; ++a) least = std::min(least, steps_mm[index(a)]);
    return least;
  }
  motion::Limits limits() const {
    using settings::Id;
    settings::Values values = bench::machine_settings(nominal_hz, 4, 0.1, axes, 200);
    const auto set = [&](Id id, int a, double value) {
      values.set_milli(settings::for_axis(id, a),
                       static_cast<std::int32_t>(std::lround(value * 1e3)));
    };
    for (int a = 0; a < axes; ++a) {
      set(Id::steps_per_mm_x, a, steps_mm[index(a)]);
      set(Id::max_rate_x, a, speed_mm_s[index(a)] * 60);
      set(Id::acceleration_x, a, accel_mm_s2[index(a)]);
      set(Id::jerk_x, a, jerk_m_s3[index(a)]);
      set(Id::speed_jump_x, a, jump_mm_s[index(a)]);
    }
    return bench::limits_of(values);
  }
  motion::LineLimits line_limits(const motion::Limits& limits) const {
    return motion::make_line_limits(limits,
                                    static_cast<std::int32_t>(std::lround(coarsest() * 1000)),
                                    static_cast<std::uint32_t>(std::lround(deviation_mm * 1e6)));
  }
};

/// The planner and its output so far.
class LineRig {
 public:
  explicit LineRig(const LineMachine& machine)
      : machine_(machine), limits_(machine.limits()), line_limits_(machine.line_limits(limits_)) {
    stepper::MotionState at;
    for (stepper::AxisState& a : at.axis) a.position_q64 = stepper::middle_of_step(0);
    planner_.start(at);
    from_ = at;
  }

  motion::LinePlanner& planner() { return planner_; }
  const LineMachine& machine() const { return machine_; }
  const motion::Limits& limits() const { return limits_; }
  const motion::LineLimits& line_limits() const { return line_limits_; }
  const std::vector<LineSegment>& segments() const { return segments_; }
  /// Checks segments tick by tick for the first `ticks` ticks, then only at their ends.
  void check_ticks(long ticks) { ticks_to_sum_ = ticks; }

  /// Line numbers are indices of targets.
  bool push(LineTarget target) {
    target.line = static_cast<std::uint32_t>(targets_.size());
    if (!planner_.push(target)) return false;
    targets_.push_back(target);
    return true;
  }
  /// Checks one segment; false if there is none.
  bool step() {
    LineSegment s;
    if (!planner_.next(s)) return false;
    check_segment(s);
    stood_ = false;
    segments_.push_back(s);
    from_ = s.segment.end;
    return !testing::Test::HasFatalFailure();
  }
  /// Simulates segments that are late: the machine brakes from its position and continues from
  /// there.
  template <class Meanwhile>
  void miss(std::uint64_t count, Meanwhile meanwhile) {
    const motion::LinePlanner::Mark mark = planner_.mark();
    LineSegment lost;
    for (std::uint64_t i = 0; i < count; ++i) planner_.next(lost);
    meanwhile();
    from_ = motion::make_brake(from_, motion::BrakeLimits(limits_)).end;
    planner_.return_to(mark, from_);
    stood_ = true;
  }
  void miss(std::uint64_t count) {
    miss(count, [] {});
  }
  /// Runs all remaining segments.
  void run() {
    while (step()) {
    }
  }
  /// Streams all targets; the ring is kept as full as possible, or at up to `ahead` lines.
  void stream(const std::vector<LineTarget>& targets, std::uint32_t ahead = 1000) {
    std::size_t next = 0;
    for (;;) {
      while (next < targets.size() && planner_.lines() < ahead && push(targets[next])) ++next;
      if (!step()) break;
    }
  }
  double seconds() const { return static_cast<double>(from_.tick) * 1e-6; }
  /// Speed along the path, at the end of a segment (below: at its start).
  double speed_mm_s(const LineSegment& s) const {
    PerAxis<std::int64_t> speeds{};
    for (int a = 0; a < machine_.axes; ++a)
      speeds[index(a)] = s.segment.end.axis[index(a)].speed_q62;
    return norm_mm_s(speeds);
  }
  double start_mm_s(const LineSegment& s) const {
    PerAxis<std::int64_t> speeds{};
    for (int a = 0; a < machine_.axes; ++a) speeds[index(a)] = s.segment.axis[index(a)].speed_q62;
    return norm_mm_s(speeds);
  }
  double cruise_mm_s(const LineSegment& s) const {
    PerAxis<std::int64_t> speeds{};
    for (int a = 0; a < machine_.axes; ++a)
      speeds[index(a)] = s.segment.axis[index(a)].cruise_speed_q62();
    return norm_mm_s(speeds);
  }
  /// Change of speed by the acceleration in a tick, mm/s.
  double tick_of_accel() const {
    double squares = 0;
    for (int a = 0; a < machine_.axes; ++a) squares += std::pow(machine_.accel_mm_s2[index(a)], 2);
    return std::sqrt(squares) * 1e-6;
  }
  const stepper::MotionState& at() const { return from_; }
  const std::vector<LineTarget>& targets() const { return targets_; }

 private:
  void check_segment(const LineSegment& line);
  void check_joint(const LineSegment& line) const;
  double norm_mm_s(const PerAxis<std::int64_t>& speeds_q62) const {
    double squares = 0;
    for (int a = 0; a < machine_.axes; ++a)
      squares += std::pow(line_q62(speeds_q62[index(a)]) * 1e6 / machine_.steps_mm[index(a)], 2);
    return std::sqrt(squares);
  }

  LineMachine machine_;
  motion::Limits limits_;
  motion::LineLimits line_limits_;
  motion::LineRing ring_;
  motion::LinePlanner planner_{ring_, line_limits_, limits_};
  std::vector<LineTarget> targets_;
  std::vector<LineSegment> segments_;
  stepper::MotionState from_;
  long ticks_to_sum_ = 0;
  bool stood_ = false;  ///< at rest, even if the last segment ends at a speed
};

inline double steps_off_middle(Int128 position_q64, std::int32_t step) {
  return std::ldexp(static_cast<double>(native(position_q64 - stepper::middle_of_step(step))), -64);
}

/// The same relative to a place.
inline double steps_off(Int128 position_q64, const motion::LinePlace& place, int axis) {
  return std::ldexp(
      static_cast<double>(native(position_q64 - motion::position_of(place, index(axis)))), -64);
}

/// Checks that the machine is at rest at the end of the last line.
inline void expect_at_end(const LineRig& rig) {
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  ASSERT_TRUE(rig.at().at_rest());
  for (int a = 0; a < rig.machine().axes; ++a)
    ASSERT_LT(std::fabs(steps_off(rig.at().axis[index(a)].position_q64, rig.targets().back(), a)),
              2e-6);
}

/// Checks that after a cancel the machine is at rest in the middle of a step, with no lines left.
inline void expect_cancelled(LineRig& rig) {
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  ASSERT_TRUE(rig.planner().idle());
  ASSERT_FALSE(rig.planner().held());
  ASSERT_TRUE(rig.at().at_rest());
  for (int a = 0; a < rig.machine().axes; ++a) {
    const Int128 at = rig.at().axis[index(a)].position_q64;
    ASSERT_LT(std::fabs(steps_off_middle(at, static_cast<std::int32_t>(at.hi()))), 2e-6);
  }
}

/// The speed along the path is continuous except for rounding to whole ticks of both segments.
inline void LineRig::check_joint(const LineSegment& line) const {
  const double start = start_mm_s(line);
  const double end = segments_.empty() || stood_ ? 0 : speed_mm_s(segments_.back());
  if (end == 0) {
    ASSERT_LE(start, tick_of_accel() / 8);
    return;
  }
  const LineSegment& before = segments_.back();
  // A move back (settles) ends exactly at its end, as a line does.
  const auto fits = [](const LineSegment& s) { return s.ends_line || s.settles; };
  const double share = (fits(line) || fits(before) ? 4.0 / line.segment.ticks : 0) +
                       (fits(before) ? 4.0 / before.segment.ticks : 0);
  // Rounding of the search for speeds with jerk pulses.
  const double noise = line_limits_.rise.none() ? 1e-7 : 0x1p-11;
  ASSERT_NEAR(start, end, std::max(start, end) * (share + noise) + 1e-6 + tick_of_accel());
}

inline void LineRig::check_segment(const LineSegment& line) {
  ASSERT_NO_FATAL_FAILURE(check_joint(line));
  const stepper::Segment& s = line.segment;
  SCOPED_TRACE(testing::Message() << "segment " << segments_.size() << ", line " << line.line
                                  << " of " << targets_.size() << ", ticks " << s.ticks);
  ASSERT_EQ(s.start_tick, from_.tick);
  ASSERT_GE(s.ticks, 1u);
  if (!line.settles) {
    ASSERT_LE(s.ticks, motion::line_slice_ticks);
  }
  ASSERT_EQ(s.end.tick, s.start_tick + s.ticks);
  const bool every_tick = ticks_to_sum_ > 0;
  ticks_to_sum_ -= s.ticks;
  for (int a = 0; a < machine_.axes; ++a) {
    SCOPED_TRACE(testing::Message() << "axis " << a);
    const stepper::AxisProfile& p = s.axis[index(a)];
    const motion::AxisLimits& limit = limits_.axis[index(a)];
    ASSERT_EQ(p.ticks(), s.ticks);
    for (const std::int64_t speed : {p.speed_q62, p.cruise_speed_q62(), p.end_speed_q62()})
      ASSERT_LE(abs64(speed), limit.speed_q62);
    ASSERT_LE(abs64(p.lead_accel_q62), limit.accel_q62) << p.lead_ticks;
    ASSERT_LE(abs64(p.tail_accel_q62), limit.accel_q62) << p.tail_ticks;
    const stepper::AxisState& end = s.end.axis[index(a)];
    ASSERT_EQ(native(end.position_q64),
              native(from_.axis[index(a)].position_q64 + (stepper::displacement_q62(p) << 2)));
    ASSERT_LE(abs64(p.end_speed_q62() - end.speed_q62), 40 * std::int64_t{s.ticks});
    if (line.ends_line) {
      ASSERT_LT(std::fabs(steps_off(end.position_q64, targets_[line.line], a)), 2e-6);
    }
    ASSERT_TRUE(motion::keeps_jerk(p, limit.jerk_q78))
        << p.lead_ticks << " " << p.cruise_ticks << " " << p.tail_ticks;
    if (every_tick) {
      JerkWatch watch(limit);
      watch.allow_stairs(p);
      watch.tick(0);
      for_each_tick(p, [&](Native, std::int64_t, std::int64_t accel) { watch.tick(accel); });
      watch.tick(0);
      ASSERT_FALSE(watch.broken()) << watch.worst() << " stairs";
      const TickSum sum = sum_ticks(p);
      ASSERT_LE(sum.max_speed_q62, limit.speed_q62);
      ASSERT_LE(sum.max_accel_q62, limit.accel_q62);
      ASSERT_EQ(sum.sign_changes_outside_turns, 0);
      ASSERT_EQ(native(end.position_q64) - native(from_.axis[index(a)].position_q64),
                sum.end_q62 << 2);
    }
  }
}

}  // namespace lamplock::test
