#include "firmware/motion/profile/scaled_reach.hpp"

#include <bit>

namespace lamplock::motion {
namespace {

/// Bits of a speed limit.
constexpr int limit_bits = 27;
/// A finer scale has no benefit, and a beat must fit.
constexpr int max_scale_bits = 28;

std::uint32_t bits_of(std::int32_t x) { return static_cast<std::uint32_t>(x); }

/// Root, rounded down and up to two units less.
std::int32_t root(std::uint64_t x) { return static_cast<std::int32_t>(nearly_isqrt(x)); }

/// Leading zero bits of a positive number, without the sign bit.
int spare_bits(std::int32_t x) { return std::countl_zero(bits_of(x)) - 1; }

/// Root of a product of two positive numbers, in 32 bits: too small by at most 2^-28 of itself and
/// one unit. The spare bits of the first one are known.
std::int32_t root_of_product(std::int32_t x, int x_shift, std::int32_t y) {
  const int y_shift = spare_bits(y);
  const std::uint32_t a = bits_of(x) << x_shift, b = bits_of(y) << y_shift;
  // Upper half of the product, at most three too small.
  const std::uint32_t a1 = a >> 16, a0 = a & 0xffffu, b1 = b >> 16, b0 = b & 0xffffu;
  std::uint32_t n = a1 * b1 + (a1 * b0 >> 16) + (a0 * b1 >> 16);
  int shift = x_shift + y_shift;
  if ((shift & 1) != 0) {
    n <<= 1;
    ++shift;
  }
  if (n >= 1u << 30) {
    n >>= 2;
    shift -= 2;
  }
  return static_cast<std::int32_t>((root_of_upper_half(n) - 2) >> (shift / 2));
}

/// A time, in the format of a speed if it fits.
struct Time {
  std::int32_t beats;
  std::int32_t t_qs;  ///< 0: longer than eight times the limit
  int spare = 0;      ///< spare_bits(t_qs)
};

/// Least start speed, not below -V, from which the distance can be covered: accelerate all the way,
/// at most to the limit.
[[gnu::always_inline]] inline std::int32_t min_start_qs(const AxisScale& axis, const Time& time,
                                                        std::int32_t mean_up) {
  const std::int32_t limit = axis.limit_qs;
  std::int32_t least = -limit;
  if (time.t_qs != 0 && mean_up <= limit - time.t_qs / 2) {
    least = mean_up - time.t_qs / 2;
  } else {
    const std::uint64_t left = wide_product(bits_of(time.beats), bits_of(limit - mean_up));
    if (left < axis.far) least = limit - root(left << (axis.bits + 1));
  }
  return least > -limit ? least : -limit;
}

/// Largest end speed from a start speed: brake first, then accelerate; limited.
std::int32_t max_end_qs(const AxisScale& axis, const Time& time, std::int32_t mean_down,
                        std::int32_t v) {
  const std::int32_t limit = axis.limit_qs;
  if (time.t_qs != 0) {
    const std::int32_t spare = time.t_qs / 2 + mean_down - v;
    const std::int32_t r = spare > 0 ? root_of_product(time.t_qs, time.spare, spare) : 0;
    const std::int32_t dip = v - time.t_qs + r;
    if (dip >= -limit) return dip + r < limit ? dip + r : limit;
  }
  const std::uint64_t way = wide_product(bits_of(time.beats), bits_of(limit + mean_down));
  if (way >= axis.far) return limit;
  const std::uint64_t twice = way << (axis.bits + 1);
  const std::uint64_t start = wide_product(bits_of(v + limit), bits_of(v + limit)) + 1;
  const std::int32_t end = (twice > start ? root(twice - start) : 0) - limit;
  return end < limit ? end : limit;
}

}  // namespace

AxisScale make_scale(std::int64_t speed_limit_q32) {
  AxisScale scale;
  scale.bits = max_scale_bits;
  while (scale.bits > 0 && speed_limit_q32 >> (32 - scale.bits) >= std::int64_t{1} << limit_bits)
    --scale.bits;
  scale.limit_qs = scale.scaled(speed_limit_q32);
  const std::uint64_t square = wide_product(bits_of(scale.limit_qs), bits_of(scale.limit_qs));
  scale.far = (4 * square >> scale.bits) + 1;
  scale.lasting_beats =
      static_cast<std::int32_t>(8 * std::int64_t{scale.limit_qs} >> scale.bits) + 1;
  return scale;
}

bool reach(const AxisScale& axis, const SpeedRange& from, const MeanSpeed& mean, std::int32_t beats,
           SpeedRange& to) {
  if (mean.up_qs > axis.limit_qs || mean.down_qs < -axis.limit_qs) return false;
  Time time{beats, beats < axis.lasting_beats ? beats << axis.bits : 0};
  const std::int32_t least = min_start_qs(axis, time, mean.up_qs);
  const std::int32_t lo = from.lo_qs > least ? from.lo_qs : least;
  const std::int32_t most = -min_start_qs(axis, time, -mean.down_qs);
  const std::int32_t hi = from.hi_qs < most ? from.hi_qs : most;
  if (lo > hi) return false;
  if (time.t_qs != 0) time.spare = spare_bits(time.t_qs);
  // Both bounds fall with the start speed, hence the crossed arguments.
  to.hi_qs = max_end_qs(axis, time, mean.down_qs, lo);
  to.lo_qs = -max_end_qs(axis, time, -mean.up_qs, -hi);
  return to.lo_qs <= to.hi_qs;
}

}  // namespace lamplock::motion
