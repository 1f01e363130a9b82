// Paths for tests of the path planner: their plans as made by the machine, and the exact optimum in
// double precision.  The reference has the same corners as the firmware (path/geometry.hpp),
// computed independently in double precision, and the true limits. Along a path there is one speed,
// so labels (beats, interval of speeds) with dominance are exact.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "firmware/motion/path/planner.hpp"
#include "host/bench/reference_planner.hpp"
#include "tests/motion/chain.hpp"

namespace lamplock::test {

/// Called for every window: the planner after planning it, and the request.
using PathObserver = std::function<void(const motion::PathPlanner&, const motion::PlanRequest&)>;

/// Plans a chain as the machine does (host/bench/plan_stream.hpp).
inline ChainPlan plan_path(const Chain& chain, motion::PathPlanner& planner,
                           const PathObserver& observe = {},
                           std::uint32_t queued_at_once = motion::PointQueue::capacity) {
  constexpr std::uint32_t window = window_points;
  const auto queue = std::make_unique<motion::PointQueue>();
  const auto total = static_cast<std::uint32_t>(chain.targets.size());
  queue->reset(0);
  ChainPlan plan;
  motion::PlanRequest request;
  request.queue = queue.get();
  request.mode = wire::JoinMode::path;
  request.limits = &chain.limits;
  request.start = rest_at_zero();
  for (std::uint32_t next = 0; next < total;) {
    while (queue->end() < total && queue->size() < std::max(queued_at_once, window))
      queue->push(chain.targets[queue->end()]);
    request.count = std::min(window, total - next);
    for (std::uint32_t i = 0; i < request.count; ++i) request.points[i] = next + i;
    request.follows = next != 0;
    std::uint32_t failed = 0;
    plan.result = planner.plan(request, failed);
    if (plan.result != Result::ok) return plan;
    if (observe) observe(planner, request);
    const std::uint32_t commit = request.commits();
    for (std::uint32_t i = 0; i < commit; ++i) {
      plan.segments.push_back(planner.segment(i));
      plan.beats.push_back(planner.beats(i));
    }
    for (std::uint32_t i = 0; i < commit; ++i) queue->mark_done(next + i);
    request.start = plan.segments.back().end;
    next += commit;
  }
  return plan;
}

using Vector = std::array<double, max_axes>;

inline double from_q62(std::int64_t v) { return std::ldexp(static_cast<double>(v), -62); }

/// Displacement to point i of a chain that starts at zero.
inline Vector way_to(const Chain& chain, std::size_t i) {
  Vector way{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a)
    way[a] = static_cast<double>(chain.targets[i].steps[a]) -
             (i == 0 ? 0.0 : static_cast<double>(chain.targets[i - 1].steps[a]));
  return way;
}

/// Length in steps of the coarsest axis.
inline double length_of(const Chain& chain, const Vector& way) {
  double squares = 0;
  for (std::size_t a = 0; a < way.size(); ++a) {
    const double w = way[a] * chain.limits.axis[a].weight_q31 / 2147483648.0;
    squares += w * w;
  }
  return std::sqrt(squares);
}

/// Highest speed through the corner between two moves, steps of the coarsest axis per beat.
/// `slack` is the tolerance for the change of a direction.
inline double real_corner_speed(const Chain& chain, const Vector& from, const Vector& to,
                                double slack = 1.5e-8) {
  const double l0 = length_of(chain, from), l1 = length_of(chain, to);
  double speed = 1e300;
  double cosine = 0;
  bool back = true;
  for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
    const double jump = from_q62(chain.limits.axis[a].jump_q62) * chain.limits.beat_ticks;
    const double u0 = from[a] / l0, u1 = to[a] / l1;
    const double weight = chain.limits.axis[a].weight_q31 / 2147483648.0;  // a length is in mm
    cosine += weight * weight * u0 * u1;
    const double rounding = 1 / l0 + 1 / l1 + slack;
    if (std::fabs(u0 + u1) > rounding + 3e-8 - 2 * slack) back = false;
    const double change = std::fabs(u1 - u0);
    if (change < slack) continue;
    speed = std::min(speed, (jump + motion::rounding_jump_steps) / change);
    if (change > rounding) speed = std::min(speed, jump / (change - rounding));
  }
  return back && cosine < -6e-8 ? 0 : speed;
}

/// Fewest beats for a whole path, rest to rest.
class PathReference {
 public:
  /// With the true limits, or with the planner's limits, reduced for rounding to ticks.
  static long fewest_beats(const Chain& chain, bool as_planned = false) {
    const std::size_t n = chain.targets.size();
    std::vector<Label> labels{{0, {0, 0}}};
    for (std::size_t i = 0; i < n; ++i) {
      const Line line = line_to(chain, i, as_planned);
      double end = 0;
      if (i + 1 < n && line.length != 0) {
        const Line next = line_to(chain, i + 1, as_planned);
        if (next.length != 0)
          end = std::min({real_corner_speed(chain, line.way, next.way), line.speed, next.speed});
      }
      std::vector<Label> found;
      for (const Label& from : labels) extend(line, from, end, found);
      labels = std::move(found);
    }
    long best = 1L << 40;
    for (const Label& label : labels)
      if (label.speeds.lo <= 0) best = std::min(best, label.beats);
    return best;
  }

 private:
  struct Label {
    long beats;
    bench::SpeedRange speeds;  ///< steps of the coarsest axis per beat
  };
  struct Line {
    Vector way{};
    double length = 0, accel = 0, speed = 0;
  };

  static Line line_to(const Chain& chain, std::size_t i, bool as_planned) {
    Line line{way_to(chain, i), 0, 1e300, 1e300};
    line.length = length_of(chain, line.way);
    const double beat = chain.limits.beat_ticks;
    for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
      const double direction = std::fabs(line.way[a]) / line.length;
      if (line.length == 0 || direction == 0) continue;
      const motion::AxisLimits& axis = chain.limits.axis[a];
      const double accel = from_q62(as_planned ? axis.plan_accel_q62 : axis.accel_q62);
      const double speed = from_q62(as_planned ? axis.plan_speed_q62 : axis.speed_q62);
      line.accel = std::min(line.accel, accel * beat * beat / direction);
      line.speed = std::min(line.speed, speed * beat / direction);
    }
    return line;
  }

  static void extend(const Line& line, const Label& from, double end, std::vector<Label>& found) {
    if (line.length == 0) {
      if (from.speeds.lo <= 0) add(found, {from.beats + 1, {0, 0}});
      return;
    }
    const double a = line.accel, half = line.speed / a / 2, d = line.length / a;
    const bench::SpeedRange start{from.speeds.lo / a - half,
                                  std::min(from.speeds.hi / a, 2 * half) - half};
    const auto first = static_cast<long>(std::ceil(d / (2 * half) - 1e-9));
    // Once rest is possible, more beats give nothing new. The latest time for that: brake, wait,
    // and half as long again for whole beats.
    const long last = first + 3 + static_cast<long>(4 * (2 * half + std::sqrt(d)));
    for (long k = std::max(1L, first); k <= last; ++k) {
      bench::SpeedRange to;
      const auto t = static_cast<double>(k);
      if (!bench::reach(start, d - half * t, t, half, to)) continue;
      to = {std::max(0.0, (to.lo + half) * a), std::min(end, (to.hi + half) * a)};
      if (to.lo < 1e-9 * line.speed) to.lo = 0;
      if (to.lo > to.hi) continue;
      add(found, {from.beats + k, to});
      if (to.lo == 0) return;
    }
  }

  static void add(std::vector<Label>& labels, const Label& label) {
    const auto covers = [](const Label& a, const Label& b) {
      return a.beats <= b.beats && a.speeds.lo <= b.speeds.lo && a.speeds.hi >= b.speeds.hi;
    };
    for (const Label& other : labels)
      if (covers(other, label)) return;
    std::erase_if(labels, [&](const Label& other) { return covers(label, other); });
    labels.push_back(label);
  }
};

}  // namespace lamplock::test
