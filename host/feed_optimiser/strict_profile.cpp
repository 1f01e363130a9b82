// The profile that keeps all limits, see profile.hpp.
//
// Accelerations per step, with A_m = h (J_0 + ... + J_(m-1)): A_1 ... A_m, A_m q times, A_(m-1) ...
// A_1, then 0 in the hold, then the same with the other sign, then 0. They are T = 2 m - 1 + q and
// C and T and 1 steps. The speed of the hold is V = 2 (A_1 + ... + A_m) - A_m + q A_m, and because
// the speeds of the ramps add up in pairs, the length is V (T + C) exactly. All accelerations are
// multiplied by one number of at most 1, so that this is the length of the block.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/feed_optimiser/profile.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// Shapes with a rise shorter by up to this number of steps are compared.
constexpr std::size_t compared_rises = 12;
/// Room for the rounding of the sums.
constexpr double rounding_room = 1 - 1e-9;

struct StepLimits {
  double speed, accel;  ///< mm/step, mm/step^2
};

class Search {
 public:
  Search(const Task& task, const LawTable& table)
      : length_(task.length_mm),
        limits_{task.limits.speed_mm_s * table.period_s() * rounding_room,
                task.limits.accel_mm_s2 * table.period_s() * table.period_s() * rounding_room},
        ramp_(table, task.limits.jerk_mm_s3 * rounding_room) {}

  Profile best() {
    const std::size_t end = first_full_rise();
    for (std::size_t m = end > compared_rises ? end - compared_rises : 1; m <= end; ++m) {
      const std::size_t level = first_full_level(m);
      for (std::size_t q = level > 2 ? level - 2 : 0; q <= level; ++q) consider(m, q);
      if (level > 2) consider(m, 0);
    }
    if (best_.accelerate == 0) require_step_count(std::numeric_limits<double>::max());
    require_step_count(static_cast<double>(best_.steps()));
    return best_;
  }

 private:
  double speed(std::size_t m, std::size_t q) const {
    return 2 * ramp_.accel_sum(m) + (static_cast<double>(q) - 1) * ramp_.accel(m);
  }
  double shortest(std::size_t m, std::size_t q) const {
    return speed(m, q) * static_cast<double>(2 * m + q);
  }
  /// The part of the accelerations that a shape may have.
  double permitted(std::size_t m, std::size_t q) const {
    return std::min({1.0, limits_.accel / ramp_.accel(m), limits_.speed / speed(m, q)});
  }
  bool is_full(std::size_t m, std::size_t q) const {
    return speed(m, q) >= limits_.speed || shortest(m, q) >= length_;
  }

  /// The shortest rise that reaches a limit, or the length without a hold.
  std::size_t first_full_rise() const {
    const auto full = [&](std::size_t m) {
      return is_full(m, 0) || ramp_.accel(m) >= limits_.accel;
    };
    std::size_t high = 1;
    while (!full(high)) high *= 2;
    std::size_t low = high / 2;  // not full, or 0
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (full(middle) ? high : low) = middle;
    }
    return high;
  }

  std::size_t first_full_level(std::size_t m) const {
    if (is_full(m, 0)) return 0;
    const double scale = std::min(1.0, limits_.accel / ramp_.accel(m));
    const auto full = [&](std::size_t q) {
      return speed(m, q) * scale >= limits_.speed || shortest(m, q) * scale >= length_;
    };
    std::size_t high = 1;
    while (!full(high)) high *= 2;
    std::size_t low = high / 2;
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (full(middle) ? high : low) = middle;
    }
    return high;
  }

  void consider(std::size_t m, std::size_t q) {
    const double v = speed(m, q), held = v * permitted(m, q);
    const std::size_t ramp = 2 * m - 1 + q;
    const double wanted = std::ceil(length_ / held * (1 - 1e-12)) - static_cast<double>(ramp);
    if (wanted > static_cast<double>(geometry::max_points)) return;
    const std::size_t hold = wanted > 1 ? static_cast<std::size_t>(wanted) : 1;
    const std::size_t steps = 2 * ramp + hold + 1;
    if (best_.accelerate != 0 && steps >= best_.steps()) return;
    best_.accelerate = ramp;
    best_.hold = hold;
    best_.brake = ramp + 1;
    best_.rise = m;
    best_.level = q;
    best_.scale = length_ / (v * static_cast<double>(ramp + hold));
  }

  double length_;
  StepLimits limits_;
  JerkRamp ramp_;
  Profile best_;
};

}  // namespace

Profile strict_profile(const Task& task, const LawTable& table) {
  Profile profile = Search(task, table).best();
  profile.variant = Variant::strict;
  profile.jerk_cap = task.limits.jerk_mm_s3 * rounding_room;
  return profile;
}

}  // namespace lamplock::feed_optimiser
