#include "host/order/beat_model.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/limits.hpp"

namespace lamplock::order {
namespace {

// Limit for one step: weeks at 100 Hz. Keeps infinite values out of conversions.
constexpr int max_beats = 100'000'000;

// Units of one axis: acceleration limit 1, time in beats; `limit` is that of the speed.

/// The minimum start speed for a displacement `way` in `time`; |way| <= limit * time.
double min_start(double way, double time, double limit) {
  const double speed = way / time - time / 2;
  if (speed + time <= limit) return speed;
  return limit - std::sqrt(std::max(0.0, 2 * (limit * time - way)));
}

/// The maximum end speed of a displacement that starts with `speed`: first slow, then at full
/// acceleration.
double max_end(double speed, double way, double time, double limit) {
  const double gain = -time + std::sqrt(std::max(0.0, 2 * time * time + 4 * (way - speed * time)));
  if (speed - (time - gain) / 2 < -limit) {
    const double turn = speed + limit;
    return -limit + std::sqrt(std::max(0.0, 2 * (way + limit * time) - turn * turn));
  }
  return std::min(limit, speed + gain);
}

bool reach_axis(double low, double high, double way, double time, double limit, double& to_low,
                double& to_high) {
  if (std::abs(way) > limit * time) return false;
  low = std::max(low, min_start(way, time, limit));
  high = std::min(high, -min_start(-way, time, limit));
  if (low > high) return false;
  to_high = max_end(low, way, time, limit);
  to_low = -max_end(-high, -way, time, limit);
  return to_low <= to_high;
}

double width(const SpeedBox& box) {
  double product = 1;
  for (std::size_t a = 0; a < 3; ++a) product *= 0.1 + box.high[a] - box.low[a];
  return product;
}

}  // namespace

BeatModel::BeatModel(const Motion& motion) {
  geometry::require_positive(motion.beat_s, "order", "the beat in seconds");
  for (std::size_t a = 0; a < 3; ++a) {
    geometry::require_positive(motion.accel_mm_s2[a], "order", "the acceleration of an axis");
    geometry::require_positive(motion.speed_mm_s[a], "order", "the speed of an axis");
    unit_mm_[a] = motion.accel_mm_s2[a] * motion.beat_s * motion.beat_s;
    per_mm_[a] = 1 / unit_mm_[a];
    limit_[a] = motion.speed_mm_s[a] * motion.beat_s * per_mm_[a];
    geometry::require_positive(per_mm_[a], "order", "acceleration times beat squared");
  }
}

PlanState BeatModel::any_speed() const {
  PlanState state;
  for (std::size_t a = 0; a < 3; ++a) {
    state.least.low[a] = -limit_[a];
    state.least.high[a] = limit_[a];
  }
  return state;
}

bool BeatModel::reach(const SpeedBox& from, const Way& way, double beats, SpeedBox& to) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!reach_axis(from.low[a], from.high[a], way[a], beats, limit_[a], to.low[a], to.high[a]))
      return false;
  }
  return true;
}

int BeatModel::min_beats(const SpeedBox& speeds, const Way& way) const {
  double least = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = std::abs(way[a]);
    const double speed = way[a] < 0 ? -speeds.low[a] : speeds.high[a];
    least = std::max(
        {least, size / limit_[a], -speed + std::sqrt(std::max(0.0, speed * speed + 2 * size))});
  }
  constexpr double rounding = 1e-12;
  return static_cast<int>(std::min(std::ceil(least * (1 - rounding)), double{max_beats}));
}

/// The minimum number of beats, at least `first`, for the displacement, and the speeds after it.
int BeatModel::feasible_beats(const SpeedBox& speeds, const Way& way, int first,
                              SpeedBox& to) const {
  if (reach(speeds, way, first, to)) return first;
  const int least = std::max(first + 1, min_beats(speeds, way));
  // From any speed an axis can stop and return. Long times need not be exact to the beat.
  constexpr int exact_up_to = 32;
  int beats = least;
  for (; beats < max_beats; beats += std::max(1, beats / exact_up_to)) {
    if (reach(speeds, way, beats, to)) return beats;
  }
  to = {};
  return beats;
}

int BeatModel::step(PlanState& state, const geometry::Point& from,
                    const geometry::Point& to) const {
  const Way way{(to.x - from.x) * per_mm_[0], (to.y - from.y) * per_mm_[1],
                (to.z - from.z) * per_mm_[2]};
  SpeedBox least, late;
  const int beats = feasible_beats(state.least, way, 1, least);
  // Plans with one more beat: spent in this step, or before it.
  const bool here = reach(state.least, way, beats + 1, late);
  if (state.has_late) {
    SpeedBox before;
    const int total = 1 + feasible_beats(state.late, way, 1, before);
    if (total < beats) {  // == beats would do as well: total >= 2
      state = {before, least, false};
      state.has_late = total + 1 == beats;
      return total;
    }
    if (total == beats && width(before) > width(least)) least = before;
    if (total == beats + 1 && (!here || width(before) > width(late))) {
      state = {least, before, true};
      return beats;
    }
  }
  state = {least, late, here};
  return beats;
}

long BeatModel::beats(std::span<const geometry::Point> order) const {
  PlanState state;
  long sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i) sum += step(state, order[i - 1], order[i]);
  return sum;
}

}  // namespace lamplock::order
