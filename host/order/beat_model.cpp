#include "host/order/beat_model.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/limits.hpp"

namespace lamplock::order {
namespace {

// Limit for one step: weeks at 100 Hz. Keeps infinite values out of conversions.
constexpr int max_beats = 100'000'000;

// Bounds of what floats have to represent. No displacement beyond the second is made within
// max_beats, and no speed beyond the third is reached; products of these numbers do not overflow.
constexpr double max_per_mm = 1e30, max_speed_units = 1e9, min_speed_units = 1e-12;
constexpr float max_way_units = 1e17f;

// Units of an axis: acceleration limit 1, time in beats; `limit` is that of the speed.

/// The minimum and the maximum start speed for a displacement `way` in `time`; |way| <= limit *
/// time.
SpeedBox start_speeds(const Lanes& way, const Lanes& time, const Lanes& limit) {
  const Lanes two(2), half = time * Lanes(0.5f), mean = way / time;
  SpeedBox starts{mean - half, mean + half};
  // An axis that would pass its speed limit at full acceleration moves at the limit for a while.
  if (!any_less(limit, abs(mean) + half)) return starts;
  const Lanes zero, furthest = limit * time;
  starts.low =
      where_less(limit, half + mean, limit - sqrt(max(zero, two * (furthest - way))), starts.low);
  starts.high =
      where_less(limit, half - mean, sqrt(max(zero, two * (furthest + way))) - limit, starts.high);
  return starts;
}

/// The maximum end speed of a displacement that starts with `speed`: first slow, then at full
/// acceleration.
Lanes max_end(const Lanes& speed, const Lanes& way, const Lanes& time, const Lanes& limit) {
  const Lanes zero, two(2), four(4);
  const Lanes gain = sqrt(max(zero, two * time * time + four * (way - speed * time))) - time;
  const Lanes end = min(limit, speed + gain), slowest = speed - (time - gain) * Lanes(0.5f);
  if (!any_less(slowest, zero - limit)) return end;
  const Lanes turn = speed + limit;
  return where_less(slowest, zero - limit,
                    sqrt(max(zero, two * (way + limit * time) - turn * turn)) - limit, end);
}

float width(const SpeedBox& box) {
  const Lanes widths = Lanes(0.1f) + box.high - box.low;
  return widths[0] * widths[1] * widths[2];
}

}  // namespace

BeatModel::BeatModel(const Motion& motion) {
  geometry::require_positive(motion.beat_s, "order", "the beat in seconds");
  std::array<float, 3> per_mm{}, limit{};
  for (std::size_t a = 0; a < 3; ++a) {
    geometry::require_positive(motion.accel_mm_s2[a], "order", "the acceleration of an axis");
    geometry::require_positive(motion.speed_mm_s[a], "order", "the speed of an axis");
    unit_mm_[a] = motion.accel_mm_s2[a] * motion.beat_s * motion.beat_s;
    const double exact = 1 / unit_mm_[a];
    geometry::require_positive(exact, "order", "acceleration times beat squared");
    per_mm[a] = static_cast<float>(std::min(exact, max_per_mm));
    limit[a] = static_cast<float>(
        std::clamp(motion.speed_mm_s[a] * motion.beat_s * exact, min_speed_units, max_speed_units));
  }
  per_mm_ = Lanes(per_mm[0], per_mm[1], per_mm[2], 0);
  limit_ = Lanes(limit[0], limit[1], limit[2], 1);  // the spare axis never moves
}

PlanState BeatModel::any_speed() const {
  PlanState state;
  state.least.low = Lanes() - limit_;
  state.least.high = limit_;
  return state;
}

bool BeatModel::reach(const SpeedBox& from, const Lanes& way, int beats, SpeedBox& to) const {
  const Lanes time(static_cast<float>(beats)), zero;
  if (any_less(limit_ * time, abs(way))) return false;
  const SpeedBox starts = start_speeds(way, time, limit_);
  const Lanes low = max(from.low, starts.low), high = min(from.high, starts.high);
  if (any_less(high, low)) return false;
  to.high = max_end(low, way, time, limit_);
  to.low = zero - max_end(zero - high, zero - way, time, limit_);
  return !any_less(to.high, to.low);
}

int BeatModel::min_beats(const SpeedBox& speeds, const Lanes& way) const {
  const Lanes zero, size = abs(way);
  const Lanes speed = where_less(way, zero, zero - speeds.low, speeds.high);
  const Lanes accelerating = sqrt(max(zero, speed * speed + Lanes(2) * size)) - speed;
  const Lanes least = max(Lanes(1), max(size / limit_, accelerating));
  constexpr float rounding = 1e-6f;
  const float all = std::max({least[0], least[1], least[2]}) * (1 - rounding);
  return static_cast<int>(std::min(std::ceil(static_cast<double>(all)), double{max_beats}));
}

/// The minimum number of beats, at least `first`, for the displacement, and the speeds after it.
int BeatModel::feasible_beats(const SpeedBox& speeds, const Lanes& way, int first,
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
  const Lanes far(max_way_units);
  const Lanes exact = Lanes(static_cast<float>(to.x - from.x), static_cast<float>(to.y - from.y),
                            static_cast<float>(to.z - from.z), 0) *
                      per_mm_;
  const Lanes way = min(max(exact, Lanes() - far), far);
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
