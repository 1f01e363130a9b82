#include "firmware/motion/line/rise.hpp"

#include "firmware/motion/line/slice.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {
namespace {

/// Maximum loss of a pulse by rounding to stairs, ticks (limits.cpp).
constexpr std::uint32_t stair_rounding = 16;
/// A change below this part of a tick is none, 2^-4, if the jerk reaches it in one.
constexpr int no_change_bits = 4;
/// From zero, the first try is this part: 2^-3.
constexpr int first_share_bits = 3;
/// Speeds are found to 2^-18 of their interval.
constexpr int search_steps = 18;

/// Distance of two speeds; not zero if a change is needed between them.
UFloat apart(UFloat a, UFloat b) { return most(difference(a, b), difference(b, a)); }

}  // namespace

UFloat middle_of(UFloat low, UFloat high) {
  return is_zero(low) ? times_power(high, -first_share_bits) : times_power(low + high, -1);
}

LineRise make_rise(const Limits& limits) {
  LineRise rise;
  for (int a = 0; a < limits.axes; ++a) {
    const AxisLimits& axis = limits.axis[index(a)];
    if (axis.jerk_q78 == 0) continue;
    const UFloat accel(static_cast<std::uint64_t>(axis.accel_q62), -62);
    rise.ticks = most(rise.ticks, accel / UFloat(static_cast<std::uint64_t>(axis.jerk_q78), -78));
  }
  const UFloat flat(flat_rise_ticks);
  if (!(flat < rise.ticks)) return {};
  rise.flat_share = flat / rise.ticks;
  // No ramp is shorter than a stair.
  rise.ticks = most(rise.ticks, UFloat(stepper::min_stair_ticks));
  rise.half_slice = UFloat(line_slice_ticks / 2);
  const UFloat n(line_slice_ticks / 2 - stair_rounding);
  const UFloat steady = n < times_power(rise.ticks, 1) ? times_power(n * n / rise.ticks, -2)
                                                       : difference(n, rise.ticks);
  rise.half_share = steady / rise.half_slice;
  return rise;
}

UFloat LineRise::change_ticks(UFloat steady) const {
  if (steady < least(UFloat(1u, -no_change_bits), flat_share)) return {};
  UFloat n = steady < ticks ? times_power(square_root(steady * ticks), 1) : steady + ticks;
  n = n + UFloat(stair_rounding);
  if (half_slice < n) n = steady / half_share;
  return least(n, steady / flat_share + UFloat(1u));
}

UFloat LineRamps::ticks(UFloat from, UFloat to) const {
  const UFloat steady = apart(from, to) / accel;
  return rise.none() ? steady : rise.change_ticks(steady);
}

UFloat LineRamps::highest(UFloat speed, UFloat length) const {
  const UFloat length_2 = times_power(length, 1);
  const UFloat steady = square_root(speed * speed + accel * length_2);
  if (rise.none()) return steady;
  UFloat low = speed, high = steady;
  for (int i = 0; i < search_steps; ++i) {
    const UFloat middle = middle_of(low, high);
    (length_2 < way_2(speed, middle) ? high : low) = middle;
  }
  return low;
}

UFloat LineRamps::lowest(UFloat speed, UFloat length) const {
  const UFloat length_2 = times_power(length, 1);
  const UFloat steady = square_root(difference(speed * speed, accel * length_2));
  if (rise.none()) return steady;
  if (!(length_2 < way_2(speed, UFloat()))) return {};
  UFloat low = steady, high = speed;
  for (int i = 0; i < search_steps; ++i) {
    const UFloat middle = middle_of(low, high);
    (length_2 < way_2(speed, middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace lamplock::motion
