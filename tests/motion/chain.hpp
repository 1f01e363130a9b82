// Random chains of points and their plans by the firmware, for tests of planner and stepper.
//
// A chain is planned as in the machine (host/bench/plan_stream.hpp). Every window is passed to an
// observer before it is committed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "host/bench/machine.hpp"
#include "host/bench/plan_stream.hpp"

namespace lamplock::test {

/// A machine, and points for it.
struct Chain {
  settings::Values settings;
  motion::Limits limits;
  wire::JoinMode mode = wire::JoinMode::free;
  std::vector<wire::Target> targets;
};

using bench::limits_of;
using bench::machine_settings;
using bench::rest_at_zero;
using bench::WindowObserver;
using ChainPlan = bench::StreamPlan;

/// Sets the work space to the bounding box of the points and the start at zero.
inline void tighten_work_space(Chain& chain) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
    motion::AxisLimits& axis = chain.limits.axis[a];
    axis.min_steps = axis.max_steps = 0;
    for (const wire::Target& t : chain.targets) {
      axis.min_steps = std::min(axis.min_steps, t.steps[a]);
      axis.max_steps = std::max(axis.max_steps, t.steps[a]);
    }
  }
}

/// Removes soft limits.
inline void open_work_space(Chain& chain) {
  for (motion::AxisLimits& axis : chain.limits.axis) {
    axis.min_steps = -2'000'000'000;
    axis.max_steps = 2'000'000'000;
  }
}

/// A request for all points of a chain in one window, from rest at zero to rest.
struct WholeRequest {
  explicit WholeRequest(const Chain& chain) {
    request.queue = &queue;
    request.count = static_cast<std::uint32_t>(chain.targets.size());
    for (std::uint32_t i = 0; i < request.count; ++i) request.points[i] = i;
    request.limits = &chain.limits;
    request.start = rest_at_zero();
    fill(chain);
  }
  void fill(const Chain& chain) {
    queue.reset(0);
    for (const wire::Target& t : chain.targets) queue.push(t);
  }
  motion::PointQueue queue;
  motion::PlanRequest request;
};

/// Random machine and walk: lamps of 1 Hz to 5 kHz, 1 to 4 axes, step lengths over three decades
/// around the distance of one beat, directions uniform or correlated.
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
  chain.settings = machine_settings(lamp_hz, accel, speed, axes, steps_per_mm);
  chain.limits = limits_of(chain.settings);
  // From rest to rest, one beat moves an axis by A t^2 / 4, and never further than V t.
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
    wire::Target target;
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

/// Gives a machine limits of jerk: for each axis one between strict, at which its acceleration
/// takes many beats to rise, and almost none; or none.
inline void limit_jerk(Chain& chain, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  motion::Limits& limits = chain.limits;
  settings::Values values = chain.settings;
  const double beat_s = limits.beat_ticks * 1e-6;
  for (int a = 0; a < limits.axes; ++a) {
    if (random() % 8 == 0) continue;
    const double accel = values.milli(settings::Id::acceleration_x, a) * 1e-6;
    const double jerk = accel / beat_s * 0.1 * std::pow(300, unit(random));
    values.set_milli(settings::for_axis(settings::Id::jerk_x, a),
                     static_cast<std::int32_t>(std::clamp(jerk * 1e3, 10.0, 1e8)));
  }
  chain.settings = values;
  limits = limits_of(values);
  tighten_work_space(chain);
}

/// Plans a chain as the machine does. `queued_at_once` is the number of points queued ahead.
inline ChainPlan plan_chain(const Chain& chain, motion::Planner& planner,
                            const WindowObserver& observe = {},
                            std::uint32_t queued_at_once = motion::PointQueue::capacity) {
  return bench::plan_stream(chain.limits, chain.targets, {chain.mode, queued_at_once}, planner,
                            observe);
}

}  // namespace lamplock::test
