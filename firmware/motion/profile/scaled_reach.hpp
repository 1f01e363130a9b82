// The speeds that an axis can have at the next point: reach.hpp in 32 bits, for the search.
//
// In:  a range of speeds at the start, the mean speed of the way, a time in whole beats, the axis.
// Out: the range of speeds at the end that some start speed of the range can be joined to with
//      |acceleration| <= 1 and |speed| <= limit at every instant.
// Called by the planner (main loop, or the core that plans), a hundred times per point: some 600
// cycles on a Cortex-M0+, about half of what reach() takes.
//
// Normalised as in reach.hpp: time in beats, acceleration limit = 1, a speed v/A in beats. Speeds
// are fixed point with as many fractional bits as the axis' limit leaves ("qs", q scaled): the
// limit has 27 bits, so a unit is 2^-27 of it or less. Every bound is rounded inwards.
//
// With the mean speed m = q/t of a displacement q in the time t:
//   least start speed    m - t/2, or V - sqrt(2 t (V - m)) where that would pass the limit V
//   largest end speed    v - t + 2 sqrt(t (t/2 + m - v)) from the start speed v, or
//                        sqrt(2 t (V + m) - (v + V)^2) - V where the dip between would pass -V
// Largest start and smallest end are the same mirrored.
#pragma once

#include <cstdint>

#include "shared/fixed_point.hpp"

namespace lamplock::motion {

/// Closed range of normalised speeds of an axis. Not initialised, because there are many of them.
struct SpeedRange {
  std::int32_t lo_qs;
  std::int32_t hi_qs;

  constexpr bool contains(std::int32_t v) const { return lo_qs <= v && v <= hi_qs; }
  constexpr bool contains(const SpeedRange& other) const {
    return lo_qs <= other.lo_qs && other.hi_qs <= hi_qs;
  }
  constexpr std::int32_t clamp(std::int32_t v) const {
    return v < lo_qs ? lo_qs : v > hi_qs ? hi_qs : v;
  }
  constexpr bool empty() const { return lo_qs > hi_qs; }
};

/// Fixed-point format and limit of the speeds of an axis.
struct AxisScale {
  int bits = 0;                    ///< fractional bits of a speed
  std::int32_t limit_qs = 0;       ///< V
  std::int32_t lasting_beats = 1;  ///< from here on t >= 8 V: braking and returning always fits
  std::uint64_t far = 0;           ///< 4 V^2 / 2^bits: beats x speed beyond which there is no bound

  std::int32_t scaled(std::int64_t v_q32) const {
    return static_cast<std::int32_t>(v_q32 >> (32 - bits));
  }
  SpeedRange range() const { return {-limit_qs, limit_qs}; }
  std::int64_t q32(std::int32_t v_qs) const { return std::int64_t{v_qs} << (32 - bits); }
};

/// Scale for a normalised speed limit, 0 < limit <= max_beats_per_point.
AxisScale make_scale(std::int64_t speed_limit_q32);

/// Mean speed of a way, between two neighbouring numbers.
struct MeanSpeed {
  std::int32_t down_qs = 0;
  std::int32_t up_qs = 0;
};

/// Mean speed of a displacement (scaled like speeds, in beats squared, rounded down) in some beats;
/// the displacement is at most the limit times the beats.
inline MeanSpeed mean_speed(std::int64_t displacement_qs, std::int32_t beats) {
  // Rounded down: towards zero and, below zero, one less than what the next number gives.
  const auto low = static_cast<std::int32_t>(displacement_qs);
  if (low == displacement_qs) {
    if (low == 0) return {};
    const std::int32_t sign = low >> 31;
    const std::int32_t mean = (low - sign) / beats + sign;
    return {mean, mean + 1};
  }
  const std::int64_t sign = displacement_qs >> 63;
  const auto mean = static_cast<std::int32_t>((displacement_qs - sign) / beats + sign);
  return {mean, mean + 1};
}

/// Projects `from` over a way of that mean speed in `beats`; false if no speed can be reached.
bool reach(const AxisScale& axis, const SpeedRange& from, const MeanSpeed& mean, std::int32_t beats,
           SpeedRange& to);

/// False if certainly no speed of one range can be joined to one of the other: without a root, in
/// whole units of 2^-8 and products of 32 bits. Some v0 and v1 must satisfy both |q - v0 t| <= t^2
/// / 2 and |q - (v0 + v1) t / 2| <= t^2 / 4.
inline bool can_join(const AxisScale& axis, const SpeedRange& from, const SpeedRange& to,
                     std::int64_t displacement_qs, std::int32_t beats) {
  constexpr int fine_bits = 8;
  constexpr std::int32_t max_beats = 512;
  if (beats >= axis.lasting_beats || beats >= max_beats) return true;
  const auto q = static_cast<std::int32_t>(displacement_qs >> fine_bits);
  const std::int32_t half = ((beats << axis.bits) >> (fine_bits + 1)) * beats + beats + 1;
  const std::int32_t start_hi = (from.hi_qs >> fine_bits) + 1, start_lo = from.lo_qs >> fine_bits;
  if (start_hi * beats + half < q || start_lo * beats - half > q) return false;
  const std::int32_t end_hi = (to.hi_qs >> fine_bits) + 1, end_lo = to.lo_qs >> fine_bits;
  return ((start_hi + end_hi) * beats + half) / 2 >= q - 1 &&
         ((start_lo + end_lo) * beats - half) / 2 <= q + 1;
}

}  // namespace lamplock::motion
