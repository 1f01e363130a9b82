#include "host/feed_optimiser/profile.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// A curve from 0 to 1 with speed and acceleration 0 at both ends.
double smooth(double x) { return x * x * x * (10 + x * (6 * x - 15)); }

std::vector<double> printed_distances(const Profile& p, const Task& task, const LawTable& table) {
  const JerkRamp ramp(table, p.jerk_cap);
  std::vector<double> s{0};
  s.reserve(p.steps() + 1);
  double v = 0, at = 0, a = 0;
  for (std::size_t i = 0; i < p.accelerate; ++i) {
    v += ramp.accel(i + 1);
    s.push_back(at += v);
  }
  for (std::size_t i = 0; i < p.hold; ++i) s.push_back(at += v);
  const std::size_t braking = s.size();
  for (std::size_t i = 0; i < p.brake; ++i) {
    a -= ramp.jerk(i) * table.h();
    v += a;
    s.push_back(at += v);
  }
  const double rest = task.length_mm - s.back();
  const std::size_t begin = p.brake / 2;
  for (std::size_t i = begin; i < p.brake; ++i)
    s[braking + i] +=
        rest * smooth(static_cast<double>(i + 1 - begin) / static_cast<double>(p.brake - begin));
  return s;
}

/// Accelerations of a strict ramp, up to its last step with one.
template <class Step>
void each_acceleration(const Profile& p, const JerkRamp& ramp, Step step) {
  for (std::size_t i = 1; i <= p.rise; ++i) step(ramp.accel(i) * p.scale);
  for (std::size_t i = 0; i < p.level; ++i) step(ramp.accel(p.rise) * p.scale);
  for (std::size_t i = p.rise - 1; i > 0; --i) step(ramp.accel(i) * p.scale);
}

std::vector<double> strict_distances(const Profile& p, const Task& task, const LawTable& table) {
  const JerkRamp ramp(table, p.jerk_cap);
  std::vector<double> s{0};
  s.reserve(p.steps() + 1);
  double v = 0, at = 0;
  each_acceleration(p, ramp, [&](double a) { s.push_back(at += v += a); });
  for (std::size_t i = 0; i < p.hold; ++i) s.push_back(at += v);
  each_acceleration(p, ramp, [&](double a) { s.push_back(at += v -= a); });
  s.push_back(at);
  // The rounding of a long sum is not left to the last step, where it would be a jerk.
  const double part = task.length_mm / at;
  for (double& distance : s) distance *= part;
  return s;
}

}  // namespace

void require_step_count(double steps) {
  if (steps <= static_cast<double>(geometry::max_points)) return;
  throw Error(Exit::bad_input, "jerk law",
              fmt::format("a block takes more than {} control periods", geometry::max_points),
              "raise n, k or their steps, or lengthen the control period");
}

std::vector<double> distances(const Profile& profile, const Task& task, const LawTable& table) {
  std::vector<double> s = profile.variant == Variant::printed
                              ? printed_distances(profile, task, table)
                              : strict_distances(profile, task, table);
  s.back() = task.length_mm;
  return s;
}

std::vector<double> law_values(const Profile& p, const LawTable& table) {
  const JerkRamp ramp(table, p.jerk_cap);
  std::vector<double> values;
  values.reserve(p.steps());
  if (p.variant == Variant::printed) {
    for (std::size_t i = 0; i < p.accelerate; ++i) values.push_back(ramp.jerk(i));
    values.insert(values.end(), p.hold, 0.0);
    for (std::size_t i = 0; i < p.brake; ++i) values.push_back(p.switch_jerk - ramp.jerk(i));
    return values;
  }
  double before = 0;
  const auto add = [&](double a) {
    values.push_back((a - before) / table.h());
    before = a;
  };
  each_acceleration(p, ramp, add);
  for (std::size_t i = 0; i < p.hold; ++i) add(0);
  each_acceleration(p, ramp, [&](double a) { add(-a); });
  add(0);
  return values;
}

}  // namespace lamplock::feed_optimiser
