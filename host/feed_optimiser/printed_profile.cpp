// The recipe that reproduces the tables of patent PL 242312 B1, see profile.hpp.
//
// Per step of control, with h = dt^3: accelerate A += J_i h, V += A, S += V until the limit of
// speed or acceleration is reached or half of the way is passed; hold S += V; brake A -= J_i h from
// A = 0. A braking is simulated from each step of the hold. The tables have one step of hold less
// than the first simulated braking that ends within 0.01 mm: what this leaves is added over the
// second half of the braking, so that the block ends at its end.
#include <algorithm>
#include <cmath>

#include "host/feed_optimiser/profile.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// From the patent.
constexpr double end_tolerance_mm = 0.01;

/// Speeds (mm/step) and distances (mm) of a simulated braking.
struct Braking {
  std::vector<double> speed, distance;
};

Braking braking_from(double speed, const JerkRamp& ramp) {
  Braking braking;
  double a = 0, s = 0;
  for (std::size_t i = 0; speed > 0; ++i) {
    a -= ramp.jerk(i) * ramp.accel(1) / ramp.jerk(0);
    speed += a;
    if (speed <= 0) break;
    s += speed;
    braking.speed.push_back(speed);
    braking.distance.push_back(s);
  }
  return braking;
}

/// A ramp of n steps, and the state at its end.
struct Start {
  std::size_t steps = 0;
  double speed = 0, distance = 0;
};

Start start_of(const Task& task, const JerkRamp& ramp, double period_s) {
  const double max_speed = task.limits.speed_mm_s * period_s;
  const double max_accel = task.limits.accel_mm_s2 * period_s * period_s;
  Start start;
  while (start.speed < max_speed && ramp.accel(start.steps) < max_accel &&
         start.distance < task.length_mm / 2) {
    require_step_count(static_cast<double>(++start.steps));
    start.speed = ramp.accel_sum(start.steps);
    start.distance += start.speed;
  }
  return start;
}

/// Steps of braking after `begun` until the next one would pass the end.
std::size_t steps_before(double length, double begun, const Braking& braking) {
  return static_cast<std::size_t>(
      std::upper_bound(braking.distance.begin(), braking.distance.end(), length - begun) -
      braking.distance.begin());
}

}  // namespace

Profile printed_profile(const Task& task, const LawTable& table) {
  const JerkRamp ramp(table, task.limits.jerk_mm_s3);
  Start start = start_of(task, ramp, table.period_s());
  Braking braking = braking_from(start.speed, ramp);
  // The braking takes more way than the acceleration: a short block is not accelerated to its half.
  while (start.steps > 1 &&
         start.distance + (braking.distance.empty() ? 0 : braking.distance.back()) >
             task.length_mm) {
    start.distance -= start.speed;
    --start.steps;
    start.speed = ramp.accel_sum(start.steps);
    braking = braking_from(start.speed, ramp);
  }
  Profile profile;
  profile.variant = Variant::printed;
  profile.jerk_cap = task.limits.jerk_mm_s3;
  profile.accelerate = start.steps;
  profile.switch_jerk = ramp.jerk(start.steps - 1);
  std::size_t hold = 0;
  profile.brake = steps_before(task.length_mm, start.distance, braking);
  for (std::size_t c = 0;; ++c) {
    const double begun = start.distance + static_cast<double>(c) * start.speed;
    const std::size_t steps = steps_before(task.length_mm, begun, braking);
    if (steps == 0 || braking.speed[steps - 1] > start.speed / 2) break;
    hold = c;
    profile.brake = steps;
    profile.missed_mm = task.length_mm - begun - braking.distance[steps - 1];
    if (profile.missed_mm <= end_tolerance_mm) break;
  }
  profile.hold = hold == 0 ? 0 : hold - 1;
  profile.brake = std::max<std::size_t>(profile.brake, 1);
  return profile;
}

}  // namespace lamplock::feed_optimiser
