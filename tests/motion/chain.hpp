// Random chains of points and the way the firmware plans them, for tests of planner and stepper.
//
// A chain is planned as the machine does it: windows of `window_points` points, of which the first
// `commit_points` are committed. Every window is handed to an observer before it is committed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/motion/planner.hpp"

namespace lamplock::test {

/// A machine, and points for it.
struct Chain {
  motion::Limits limits;
  motion::JoinMode mode = motion::JoinMode::free;
  std::vector<motion::Target> targets;
};

/// Every segment of a chain, and the beats of each.
struct ChainPlan {
  Result result = Result::ok;
  std::vector<stepper::Segment> segments;
  std::vector<std::int32_t> beats;

  long total_beats() const {
    long sum = 0;
    for (const std::int32_t b : beats) sum += b;
    return sum;
  }
};

/// Sees every window: the planner after planning it, and what it was asked.
using WindowObserver = std::function<void(const motion::Planner&, const motion::PlanRequest&)>;

/// Settings of a machine whose axes are all alike; work space as large as the table allows.
inline settings::Values machine_settings(double lamp_hz, double accel_m_s2, double speed_m_s,
                                         int axes, double steps_per_mm) {
  using settings::Id;
  settings::Values values;
  const auto milli = [](double v) { return static_cast<std::int32_t>(std::lround(v * 1000)); };
  values.set_milli(Id::lamp_frequency, milli(lamp_hz));
  values.set_milli(Id::axes, axes * 1000);
  for (int a = 0; a < max_axes; ++a) {
    using settings::for_axis;
    values.set_milli(for_axis(Id::steps_per_mm_x, a), milli(steps_per_mm));
    values.set_milli(for_axis(Id::acceleration_x, a), milli(accel_m_s2 * 1e3));
    values.set_milli(for_axis(Id::max_rate_x, a), milli(speed_m_s * 6e4));
    values.set_milli(for_axis(Id::travel_x, a), 2'000'000);
    values.set_milli(for_axis(Id::min_corner_x, a), -1'000'000);
  }
  return values;
}

/// Limits of such a machine on its nominal beat.
inline motion::Limits limits_of(const settings::Values& values,
                                std::uint32_t tick_q16 = full_tick_q16) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  if (motion::make_limits(values, beat_ticks(values), tick_q16, limits, setting) != Result::ok)
    throw std::runtime_error("setting " + std::to_string(setting) + " refused");
  return limits;
}

/// Sets the work space to the bounding box of the points and the start at zero.
inline void tighten_work_space(Chain& chain) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
    motion::AxisLimits& axis = chain.limits.axis[a];
    axis.min_steps = axis.max_steps = 0;
    for (const motion::Target& t : chain.targets) {
      axis.min_steps = std::min(axis.min_steps, t.steps[a]);
      axis.max_steps = std::max(axis.max_steps, t.steps[a]);
    }
  }
}

/// Random machine and walk: lamps of 1 Hz to 5 kHz, 1 to 4 axes, step lengths over three decades
/// around what one beat can do, directions uniform or correlated.
inline Chain random_chain(std::mt19937_64& random, std::size_t points) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const auto log_uniform = [&](double lo, double hi) {
    return lo * std::pow(hi / lo, unit(random));
  };
  const double lamp_hz = log_uniform(1, 5000), accel = log_uniform(0.5, 30);
  const double steps_per_mm = log_uniform(50, 800);
  const double speed = std::min(log_uniform(0.02, 2), 900.0 / steps_per_mm);
  const int axes = 1 + static_cast<int>(random() % 4);
  Chain chain;
  chain.limits = limits_of(machine_settings(lamp_hz, accel, speed, axes, steps_per_mm));
  // Rest to rest, one beat takes an axis A t^2 / 4 far, and never further than V t.
  const double beat_s = 1 / lamp_hz;
  const double reach_steps =
      std::min(accel * beat_s * beat_s / 4, speed * beat_s) * 1e3 * steps_per_mm;
  const double turning = random() % 2 == 0 ? 1.0 : 0.15;
  std::array<double, max_axes> at{}, direction{};
  for (std::size_t i = 0; i < points; ++i) {
    const double length = reach_steps * log_uniform(0.03, 30);
    double norm = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(axes); ++a) {
      direction[a] = (1 - turning) * direction[a] + turning * normal(random);
      norm += direction[a] * direction[a];
    }
    motion::Target target;
    for (std::size_t a = 0; a < static_cast<std::size_t>(axes); ++a) {
      direction[a] /= std::sqrt(norm);
      const double next = at[a] + length * direction[a];
      at[a] = std::fabs(next) > 1e8 ? at[a] - length * direction[a] : next;
      target.steps[a] = static_cast<std::int32_t>(std::lround(at[a]));
    }
    if (random() % 8 == 0) target.shots = 0;
    chain.targets.push_back(target);
  }
  tighten_work_space(chain);
  return chain;
}

/// Rest at the machine's zero, on lattice tick 0.
inline stepper::MotionState rest_at_zero() {
  stepper::MotionState state;
  for (stepper::AxisState& axis : state.axis) axis.position_q64 = stepper::middle_of_step(0);
  return state;
}

/// Plans a chain as the machine does. `queued_at_once` is how far the queue is filled ahead.
inline ChainPlan plan_chain(const Chain& chain, motion::Planner& planner,
                            const WindowObserver& observe = {},
                            std::uint32_t queued_at_once = motion::PointQueue::capacity) {
  constexpr std::uint32_t window = motion::window_points;
  const auto queue = std::make_unique<motion::PointQueue>();
  const auto total = static_cast<std::uint32_t>(chain.targets.size());
  queue->reset(0);
  ChainPlan plan;
  motion::PlanRequest request;
  request.queue = queue.get();
  request.mode = chain.mode;
  request.limits = &chain.limits;
  request.start = rest_at_zero();
  for (std::uint32_t next = 0; next < total;) {
    while (queue->end() < total && queue->size() < std::max(queued_at_once, window))
      queue->push(chain.targets[queue->end()]);
    request.count = std::min(window, total - next);
    for (std::uint32_t i = 0; i < request.count; ++i) request.points[i] = next + i;
    request.rest_at_end = next + request.count == total;
    std::uint32_t failed = 0;
    plan.result = planner.plan(request, failed);
    if (plan.result != Result::ok) return plan;
    if (observe) observe(planner, request);
    const std::uint32_t commit = request.commits();
    for (std::uint32_t i = 0; i < commit; ++i) {
      plan.segments.push_back(planner.segment(i));
      plan.beats.push_back(planner.beats(i));
      queue->mark_done(next + i);
    }
    request.start = plan.segments.back().end;
    next += commit;
  }
  return plan;
}

}  // namespace lamplock::test
