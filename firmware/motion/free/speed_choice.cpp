#include "firmware/motion/free/speed_choice.hpp"

namespace lamplock::motion {
namespace {

using Beats = std::array<std::int32_t, window_points>;

/// Sweeps: the error falls to a quarter with each (the matrix is diagonally dominant by two).
constexpr int sweeps = 4;

/// Intersection; the nearest point of `box` if rounding made it empty.
SpeedRange both(const SpeedRange& box, const SpeedRange& other) {
  const std::int32_t lo = other.lo_qs > box.lo_qs ? other.lo_qs : box.lo_qs;
  const std::int32_t hi = other.hi_qs < box.hi_qs ? other.hi_qs : box.hi_qs;
  if (lo <= hi) return {lo, hi};
  const std::int32_t nearest = other.lo_qs > box.hi_qs ? box.hi_qs : box.lo_qs;
  return {nearest, nearest};
}

/// x share / 2^15, for a share of at most 2^15 and |x| < 2^31.
std::int32_t part(std::int32_t x, std::int32_t share_q15) {
  return (x >> 15) * share_q15 +
         static_cast<std::int32_t>((static_cast<std::uint32_t>(x) & 0x7fffu) *
                                       static_cast<std::uint32_t>(share_q15) >>
                                   15);
}

/// Speeds of one axis.
class AxisSpeeds {
 public:
  AxisSpeeds(const Window& window, const Improver& boxes, const Beats& beats, int a,
             std::int32_t start, Speeds& speeds)
      : window_(window),
        boxes_(boxes),
        beats_(beats),
        a_(index(a)),
        axis_(window.scale(a)),
        start_(start),
        speeds_(speeds) {}

  void choose() {
    const std::uint32_t last = window_.count - 1;
    for (std::uint32_t i = 0; i <= last; ++i) mean_[i] = mean(i).down_qs;
    for (std::uint32_t i = 0; i < last; ++i) {
      box_[i] = both(boxes_.forwards(i)[a_], boxes_.backwards(i)[a_]);
      share_q15_[i] = (beats_[i + 1] << 15) / (beats_[i] + beats_[i + 1]);
      at(i) = box_[i].clamp(mean_[i + 1] + part(mean_[i] - mean_[i + 1], 0x8000 - share_q15_[i]));
    }
    at(last) = both(boxes_.forwards(last)[a_], boxes_.backwards(last)[a_]).clamp(mean_[last]);
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (std::uint32_t i = 0; i < last; ++i) at(i) = box_[i].clamp(spline(i));
    for (std::uint32_t i = last; i-- > 0;) join(i);
  }

 private:
  std::int32_t& at(std::uint32_t i) { return speeds_[i][a_]; }
  MeanSpeed mean(std::uint32_t i) const {
    return mean_speed(window_.ways[i].displacement_qs[a_], beats_[i]);
  }
  /// The equation above over 2 (k + l).
  std::int32_t spline(std::uint32_t i) {
    const std::int32_t before = 3 * mean_[i] - (i == 0 ? start_ : at(i - 1));
    const std::int32_t after = 3 * mean_[i + 1] - at(i + 1);
    return (after + part(before - after, share_q15_[i])) / 2;
  }
  /// Limits a speed to those from which the next one can be reached.
  void join(std::uint32_t i) {
    const std::int32_t after = at(i + 1), slack = rounding_tolerance_qs + beats_[i + 1];
    SpeedRange can;
    if (!reach(axis_, {after - slack, after + slack}, mean(i + 1), beats_[i + 1], can)) return;
    at(i) = both(boxes_.forwards(i)[a_], can).clamp(at(i));
  }

  const Window& window_;
  const Improver& boxes_;
  const Beats& beats_;
  std::size_t a_;
  const AxisScale& axis_;
  std::int32_t start_;
  Speeds& speeds_;
  std::array<std::int32_t, window_points> mean_, share_q15_;
  std::array<SpeedRange, window_points> box_;
};

}  // namespace

void choose_smooth_speeds(const Window& window, const Improver& boxes, const Beats& beats, int axis,
                          std::int32_t start_qs, Speeds& speeds_qs) {
  AxisSpeeds(window, boxes, beats, axis, start_qs, speeds_qs).choose();
}

}  // namespace lamplock::motion
