#include "firmware/motion/line_rise.hpp"

#include "firmware/motion/line_slice.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {
namespace {

/// What rounding to stairs may take from a pulse, ticks (limits.cpp).
constexpr std::uint32_t stair_rounding = 16;
/// A change that takes less than this part of a tick is none, 2^-4, if the jerk gives it in one.
constexpr int no_change_bits = 4;
/// From nothing, the first try is this part: 2^-3.
constexpr int first_share_bits = 3;
/// Speeds are found to 2^-18 of what they are between.
constexpr int search_steps = 18;

/// Whether two speeds are far enough apart for a change between them; how far.
LineReal apart(LineReal a, LineReal b) { return most(difference(a, b), difference(b, a)); }

}  // namespace

LineReal middle_of(LineReal low, LineReal high) {
  return is_zero(low) ? times_power(high, -first_share_bits) : times_power(low + high, -1);
}

LineRise make_rise(const Limits& limits) {
  LineRise rise;
  for (int a = 0; a < limits.axes; ++a) {
    const AxisLimits& axis = limits.axis[index(a)];
    if (axis.jerk_q78 == 0) continue;
    const LineReal accel(static_cast<std::uint64_t>(axis.accel_q62), -62);
    rise.ticks = most(rise.ticks, accel / LineReal(static_cast<std::uint64_t>(axis.jerk_q78), -78));
  }
  const LineReal flat(flat_rise_ticks);
  if (!(flat < rise.ticks)) return {};
  rise.flat_share = flat / rise.ticks;
  // No ramp is shorter than a stair.
  rise.ticks = most(rise.ticks, LineReal(stepper::least_stair_ticks));
  rise.half_slice = LineReal(line_slice_ticks / 2);
  const LineReal n(line_slice_ticks / 2 - stair_rounding);
  const LineReal steady = n < times_power(rise.ticks, 1) ? times_power(n * n / rise.ticks, -2)
                                                         : difference(n, rise.ticks);
  rise.half_share = steady / rise.half_slice;
  return rise;
}

LineReal LineRise::change_ticks(LineReal steady) const {
  if (steady < least(LineReal(1u, -no_change_bits), flat_share)) return {};
  LineReal n = steady < ticks ? times_power(square_root(steady * ticks), 1) : steady + ticks;
  n = n + LineReal(stair_rounding);
  if (half_slice < n) n = steady / half_share;
  return least(n, steady / flat_share + LineReal(1u));
}

LineReal LineRamps::ticks(LineReal from, LineReal to) const {
  const LineReal steady = apart(from, to) / accel;
  return rise.none() ? steady : rise.change_ticks(steady);
}

LineReal LineRamps::highest(LineReal speed, LineReal length) const {
  const LineReal length_2 = times_power(length, 1);
  const LineReal steady = square_root(speed * speed + accel * length_2);
  if (rise.none()) return steady;
  LineReal low = speed, high = steady;
  for (int i = 0; i < search_steps; ++i) {
    const LineReal middle = middle_of(low, high);
    (length_2 < way_2(speed, middle) ? high : low) = middle;
  }
  return low;
}

LineReal LineRamps::lowest(LineReal speed, LineReal length) const {
  const LineReal length_2 = times_power(length, 1);
  const LineReal steady = square_root(difference(speed * speed, accel * length_2));
  if (rise.none()) return steady;
  if (!(length_2 < way_2(speed, LineReal()))) return {};
  LineReal low = steady, high = speed;
  for (int i = 0; i < search_steps; ++i) {
    const LineReal middle = middle_of(low, high);
    (length_2 < way_2(speed, middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace lamplock::motion
