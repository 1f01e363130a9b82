#include "firmware/motion/path/geometry.hpp"

#include "firmware/motion/profile/reach.hpp"

namespace lamplock::motion {
namespace {

/// Less than this is earlier rounding, not a displacement: 2^-10 step.
constexpr std::int64_t min_way_q32 = one_q32 >> 10;
/// Room between the limits and the planning limits along a line: far more than 32 significant bits
/// lose, far too little to be noticed.
constexpr int room_bits = 22;
/// Changes of direction below this are rounding of cosines and speeds themselves.
constexpr std::int64_t cosine_noise_q30 = 16;
constexpr std::int64_t square_corner_noise_q60 = cosine_noise_q30 << 32;

std::uint64_t magnitude(std::int64_t v) {
  return v < 0 ? 0 - static_cast<std::uint64_t>(v) : static_cast<std::uint64_t>(v);
}

/// Shift to the left that brings the largest magnitude to `bits` bits; negative = to the right.
int shift_to(const PerAxis<std::int64_t>& values, int bits) {
  std::uint64_t all = 0;
  for (const std::int64_t v : values) all |= magnitude(v);
  return bits - static_cast<int>(std::bit_width(all));
}

/// v * 2^left, towards zero.
std::int64_t shifted(std::int64_t v, int left) {
  if (left <= -64) return 0;
  const auto m =
      static_cast<std::int64_t>(left >= 0 ? magnitude(v) << left : magnitude(v) >> -left);
  return v < 0 ? -m : m;
}

/// Sets displacement, direction and length from a vector that is not zero, in units of 2^unit
/// steps.
void measure(const PerAxis<std::int64_t>& vector, int unit, const Limits& limits, PathLine& line) {
  const int left = shift_to(vector, 31);
  line.none = false;
  line.shift = unit - left;
  PerAxis<std::int64_t> weighted{};
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t way = shifted(vector[index(a)], left);
    line.way[index(a)] = static_cast<std::int32_t>(way);
    weighted[index(a)] = way * limits.axis[index(a)].weight_q31;
  }
  const int again = shift_to(weighted, 31);
  std::uint64_t squares = 0;
  for (std::int64_t& w : weighted) {
    w = shifted(w, again);
    squares += wide_product(static_cast<std::uint32_t>(magnitude(w)),
                            static_cast<std::uint32_t>(magnitude(w)));
  }
  const std::uint32_t root = isqrt(squares);
  line.length = Real(root, line.shift - 31 - again);
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t part_q30 = weighted[index(a)] * (std::int64_t{1} << 30);
    // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the longest has 31 bits by now
    line.cosine_q30[index(a)] = static_cast<std::int32_t>(part_q30 / root);
  }
}

/// Highest speed along the line, normalised: the axis with the least limit over displacement.
std::int64_t line_speed_q32(const PerAxis<std::int64_t>& displacement_q32, std::int64_t max_q32,
                            const Limits& limits) {
  Real least(std::uint64_t{1}, 62);
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t way = displacement_q32[index(a)];
    if (way == 0) continue;
    const Real speed =
        Real::of_q32(limits.axis[index(a)].speed_q32) * Real::of_q32(max_q32) / Real::of_q32(way);
    if (speed < least) least = speed;
  }
  const std::int64_t speed = least.fixed(32);
  constexpr std::int64_t most = std::int64_t{max_beats_per_point} << 32;
  return speed < most ? speed - (speed >> room_bits) : most;
}

/// Ticks in which the acceleration of a line rises to its peak, at least a stair (segment.hpp); 0
/// if it needs no ramp. All axes have their ramps at the same time: the axis with the least
/// acceleration, `steepest`, sets the peak, the axis with the least jerk how fast it rises; both
/// over their displacements.
Real rise_ticks(const PerAxis<std::int64_t>& steps_q32, const Limits& limits, int& steepest) {
  Real min_jerk, longest;
  bool limited = false;
  for (int a = 0; a < limits.axes; ++a) {
    const Real way = Real::of_q32(abs64(steps_q32[index(a)]));
    if (steps_q32[index(a)] == 0) continue;
    const AxisLimits& axis = limits.axis[index(a)];
    const Real way_over_accel = way / Real(magnitude(axis.accel_q62));
    if (longest < way_over_accel) {
      longest = way_over_accel;
      steepest = a;
    }
    if (axis.jerk_q78 == 0) continue;
    const Real jerk = Real(magnitude(axis.jerk_q78), -16) / way;
    if (!limited || jerk < min_jerk) min_jerk = jerk;
    limited = true;
  }
  return limited ? Real(1u) / (longest * min_jerk) : Real();
}

/// For lines with ramps: normalises the line by the peak of its pulses.
void normalise_by_peak(PathLine& line, const PerAxis<std::int64_t>& steps_q32,
                       const Limits& limits) {
  int steepest = 0;
  const Real rise = rise_ticks(steps_q32, limits, steepest);
  if (!(Real(flat_rise_ticks) < rise)) return;
  const AxisLimits& axis = limits.axis[index(steepest)];
  const Real plan(magnitude(axis.plan_accel_q62));
  const Real peak(magnitude(pulse_peak_q62(axis, limits.beat_ticks)));
  const Real way = Real::of_q32(axis.displacement_q32(abs64(steps_q32[index(steepest)])));
  const Real stair(stepper::min_stair_ticks);
  line.displacement_q32 = (way * plan / peak).fixed(32);
  line.rise_q32 = ((rise < stair ? stair : rise) / Real(limits.beat_ticks)).fixed(32) + 1;
  line.flat_q32 = (Real(flat_rise_ticks) / rise).fixed(32);
}

Real weight_of(const AxisLimits& axis) { return Real(axis.weight_q31, -31); }

/// Programmed speed jump of an axis, steps per beat.
Real jump_steps(const AxisLimits& axis, const Limits& limits) {
  return Real(magnitude(axis.jump_q62), -62) * Real(limits.beat_ticks);
}

std::int64_t change_q30(const PathLine& from, const PathLine& to, int a) {
  return abs64(std::int64_t{to.cosine_q30[index(a)]} - from.cosine_q30[index(a)]);
}

}  // namespace

PathLine make_line(const PerAxis<std::int64_t>& steps_q32, const Limits& limits) {
  PathLine line;
  PerAxis<std::int64_t> displacement{};
  std::int64_t longest = 0;
  bool some = false;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t way = abs64(steps_q32[index(a)]);
    some = some || way >= min_way_q32;
    displacement[index(a)] = limits.axis[index(a)].displacement_q32(way);
    if (displacement[index(a)] > longest) longest = displacement[index(a)];
  }
  if (!some) return line;
  measure(steps_q32, -32, limits, line);
  line.displacement_q32 = longest;
  normalise_by_peak(line, steps_q32, limits);
  line.displacement_q32 += (line.displacement_q32 >> room_bits) + 1;
  line.speed_q32 = line_speed_q32(displacement, line.displacement_q32, limits);
  return line;
}

PathLine line_of_speed(const PerAxis<std::int64_t>& speed_q62, const Limits& limits, Real& speed) {
  PathLine line;
  measure(speed_q62, -62, limits, line);
  speed = line.length * Real(limits.beat_ticks);
  return line;
}

Real speed_factor(const PathLine& from, const PathLine& to) {
  return Real::of_q32(to.displacement_q32) * from.length /
         (Real::of_q32(from.displacement_q32) * to.length);
}

std::int64_t normalised_speed_q32(const PathLine& line, Real speed) {
  return (speed * Real::of_q32(line.displacement_q32) / line.length).fixed(32);
}

Real jump_speed(const PathLine& from, const PathLine& to, const Limits& limits) {
  Real least(std::uint64_t{1}, 62);
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t change = change_q30(from, to, a);
    if (change <= cosine_noise_q30) continue;
    const AxisLimits& axis = limits.axis[index(a)];
    const Real jump = jump_steps(axis, limits) + Real(rounding_jump_steps);
    const Real speed = jump * weight_of(axis) / Real(magnitude(change + cosine_noise_q30), -30);
    if (speed < least) least = speed;
  }
  return least;
}

Real corner_speed(const PathLine& from, const PathLine& to, const Limits& limits) {
  const Real step(std::uint64_t{1});
  const Real steps_per_length = step / from.length + step / to.length;
  Real least = jump_speed(from, to, limits);
  bool back = true;
  std::int64_t cosine_q60 = 0;
  for (int a = 0; a < limits.axes; ++a) {
    const AxisLimits& axis = limits.axis[index(a)];
    const std::int64_t rounding = (weight_of(axis) * steps_per_length).fixed(30) + cosine_noise_q30;
    const std::int64_t sum = std::int64_t{from.cosine_q30[index(a)]} + to.cosine_q30[index(a)];
    if (abs64(sum) > rounding) back = false;
    cosine_q60 += std::int64_t{from.cosine_q30[index(a)]} * to.cosine_q30[index(a)];
    const std::int64_t change = change_q30(from, to, a) - rounding;
    if (change <= 0) continue;
    const Real speed = jump_steps(axis, limits) * weight_of(axis) / Real(magnitude(change), -30);
    if (speed < least) least = speed;
  }
  return back && cosine_q60 < -square_corner_noise_q60 ? Real() : least;
}

PerAxis<std::int64_t> axis_speeds_q62(const PathLine& line, std::int64_t speed_q32,
                                      std::uint32_t beat_ticks) {
  PerAxis<std::int64_t> speeds{};
  if (line.none || speed_q32 <= 0) return speeds;
  // Lines per tick, the same factor for every axis.
  const Real rate =
      Real::of_q32(speed_q32) / (Real::of_q32(line.displacement_q32) * Real(beat_ticks));
  const int shift = rate.exponent() + line.shift + 62;
  for (std::size_t a = 0; a < max_axes; ++a) {
    const std::int64_t product = std::int64_t{line.way[a]} * rate.mantissa();
    speeds[a] = shifted(product, shift);
  }
  return speeds;
}

}  // namespace lamplock::motion
