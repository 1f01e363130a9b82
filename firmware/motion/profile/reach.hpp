// The speeds that an axis can have at the next point, from those at the present point.
//
// In:  an interval of speeds at the start, a displacement, a time in whole beats, the speed limit.
// Out: the interval of speeds at the end that some start speed of the interval can be joined to
//      with |acceleration| <= 1 and |speed| <= limit at every instant.
// Called by the path planner (path/reach.hpp), some tens of times per point; scaled_reach.hpp is
// the same in 32 bits for the free planner.
//
// Units are normalised per axis: time in beats, acceleration limit = 1. A speed is v/A in beats, a
// displacement d/A in beats squared; both Q32. With u = v1 - v0 and q the displacement, the pairs
// (v0, v1) that can be joined in t form a convex set; projecting it is exact.
// Every bound is rounded inwards, so that what this file calls possible is possible.
//
// The set is symmetric in v0 and v1 (run the motion backwards and mirror it), so the same function
// also answers from which start speeds an interval of end speeds can be reached.
#pragma once

#include <cstdint>

#include "shared/fixed_point.hpp"

namespace lamplock::motion {

/// Largest time between two points, in beats; keeps every intermediate inside 64 bits.
inline constexpr std::int32_t max_beats_per_point = 8192;
/// Largest normalised displacement: half of what max_beats_per_point could do at acceleration 1.
inline constexpr std::int64_t max_displacement_q32 = std::int64_t{1} << (26 + 32);

/// Closed interval of normalised speeds, Q32 beats.
struct SpeedInterval {
  std::int64_t lo_q32 = 0;
  std::int64_t hi_q32 = 0;

  constexpr bool contains(std::int64_t v_q32) const { return lo_q32 <= v_q32 && v_q32 <= hi_q32; }
  constexpr bool contains(const SpeedInterval& other) const {
    return lo_q32 <= other.lo_q32 && other.hi_q32 <= hi_q32;
  }
  constexpr std::int64_t clamp(std::int64_t v_q32) const {
    return v_q32 < lo_q32 ? lo_q32 : v_q32 > hi_q32 ? hi_q32 : v_q32;
  }
};

/// Projects `from` over displacement `q_q32` in `beats`; false if no speed can be reached.
bool reach(const SpeedInterval& from, std::int64_t q_q32, std::int32_t beats,
           std::int64_t speed_limit_q32, SpeedInterval& to);

}  // namespace lamplock::motion
