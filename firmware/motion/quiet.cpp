#include "firmware/motion/quiet.hpp"

namespace lamplock::motion {
namespace {

using Beats = std::array<std::int32_t, window_points>;

/// Sweeps: the error falls to a quarter with each (the matrix is diagonally dominant by two).
constexpr int sweeps = 4;

/// What lies in both; the nearest point of `box` where rounding has left nothing.
SpeedInterval both(const SpeedInterval& box, const SpeedInterval& other) {
  const std::int64_t lo = other.lo_q32 > box.lo_q32 ? other.lo_q32 : box.lo_q32;
  const std::int64_t hi = other.hi_q32 < box.hi_q32 ? other.hi_q32 : box.hi_q32;
  if (lo <= hi) return {lo, hi};
  const std::int64_t nearest = other.lo_q32 > box.hi_q32 ? box.hi_q32 : box.lo_q32;
  return {nearest, nearest};
}

std::int64_t times(std::int64_t speed_q32, std::int32_t beats) {
  return times_short(speed_q32, static_cast<std::uint32_t>(beats));
}

/// Speeds of one axis.
class AxisSpeeds {
 public:
  AxisSpeeds(const Window& window, const Improver& boxes, const Beats& beats, int a,
             std::int64_t start_q32, Speeds& speeds)
      : window_(window),
        boxes_(boxes),
        beats_(beats),
        a_(index(a)),
        start_(start_q32),
        limit_(window.speed_limit_q32(a)),
        speeds_(speeds) {}

  void choose() {
    for (std::uint32_t i = 0; i < window_.count; ++i)
      at(i) = box(i).clamp(i + 1 < window_.count ? chord(i) : mean(i));
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (std::uint32_t i = 0; i + 1 < window_.count; ++i) at(i) = box(i).clamp(spline(i));
    for (std::uint32_t i = window_.count - 1; i-- > 0;) join(i);
  }

 private:
  std::int64_t& at(std::uint32_t i) { return speeds_[i][a_]; }
  SpeedInterval box(std::uint32_t i) const {
    return both(boxes_.forwards(i)[a_], boxes_.backwards(i)[a_]);
  }
  std::int64_t way(std::uint32_t i) const { return window_.ways[i].displacement_q32[a_]; }
  std::int64_t mean(std::uint32_t i) const { return way(i) / beats_[i]; }
  std::int64_t chord(std::uint32_t i) const {
    return (way(i) + way(i + 1)) / (beats_[i] + beats_[i + 1]);
  }
  std::int64_t spline(std::uint32_t i) {
    const std::int32_t k = beats_[i], l = beats_[i + 1];
    const std::int64_t before = i == 0 ? start_ : at(i - 1), behind = at(i + 1);
    const std::int64_t sum =
        3 * (times(mean(i), l) + times(mean(i + 1), k)) - times(before, l) - times(behind, k);
    return sum / (2 * (k + l));
  }
  /// Cuts a speed to those that the next one can be had from.
  void join(std::uint32_t i) {
    const std::int64_t behind = at(i + 1);
    const std::int64_t slack = 8 + 4 * beats_[i + 1] + (abs64(behind) >> 28);
    SpeedInterval can;
    if (!reach({behind - slack, behind + slack}, way(i + 1), beats_[i + 1], limit_, can)) return;
    at(i) = both(boxes_.forwards(i)[a_], can).clamp(at(i));
  }

  const Window& window_;
  const Improver& boxes_;
  const Beats& beats_;
  std::size_t a_;
  std::int64_t start_;
  std::int64_t limit_;
  Speeds& speeds_;
};

}  // namespace

void choose_quiet_speeds(const Window& window, const Improver& boxes, const Beats& beats,
                         const PerAxis<std::int64_t>& start_q32, Speeds& speeds_q32) {
  for (int a = 0; a < window.axes(); ++a)
    AxisSpeeds(window, boxes, beats, a, start_q32[index(a)], speeds_q32).choose();
}

}  // namespace lamplock::motion
