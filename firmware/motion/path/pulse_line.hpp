// The speeds that can be reached at the end of a line where the acceleration rises with limited
// jerk.
//
// In:  an interval of speeds at the start, the line, a time in whole beats, how it is divided.
// Out: the interval of speeds at the end; or the fewest beats for which it is not empty.
// Who: the path planner (main loop, or the core that plans), some tens of times per point; some 8
//      thousand cycles of a Cortex-M0+ each, the fewest beats 40 thousand. Units as in reach.hpp;
//      an acceleration of 1 is the peak of pulses.
//
// A line is run in a pulse (pulse.hpp), a steady speed and another pulse. The lengths of the pulses
// are fixed first: shares of the time, at most the time from rest to the highest speed. Then
// everything is linear in the speeds v0 and v1 at both ends: with pulses of the lengths l and m, M
// = t - (l + m)/2 and the steady speed vc
//
//   M vc = d - v0 l/2 - v1 m/2,   0 <= vc <= V,   |vc - v0| <= D(l),   |v1 - vc| <= D(m)
//
// where D is the change of speed that a pulse can make. The shortest distance to a speed v1 grows
// with v1, and so does the longest; the set of v1 with the distance between them is exact. From
// rest to rest halves are the quickest possible: the seven phases of the textbooks.
#pragma once

#include <cstdint>

#include "firmware/motion/profile/reach.hpp"

namespace lamplock::motion {

/// A line without its geometry, with its pulses.
struct PulseLine {
  std::int64_t displacement_q32 = 0;  ///< normalised, > 0
  std::int64_t speed_q32 = 0;         ///< normalised limit
  std::int64_t rise_q32 = 0;          ///< beats in which the acceleration rises to its peak
  std::int64_t flat_q32 = 0;          ///< share of the peak that needs no ramp
  std::int64_t per_rise_q32 = 0;      ///< 1 / (4 rise), with some margin
  std::int64_t max_q32 = 0;           ///< beats from rest to the highest speed: no pulse is longer
};
/// Calculates the other members; only `flat_q32` may be 0.
PulseLine make_pulse_line(std::int64_t displacement_q32, std::int64_t speed_q32,
                          std::int64_t rise_q32, std::int64_t flat_q32);

/// Ways to divide the time: halves; most of it for the first pulse; most of it for the second one.
inline constexpr int pulse_splits = 3;
/// The split of the motion run backwards.
constexpr int mirrored_split(int split) { return split == 0 ? 0 : 3 - split; }

/// Lengths of the pulses, beats.
struct PulseLengths {
  std::int64_t lead_q32 = 0;
  std::int64_t tail_q32 = 0;
};
PulseLengths pulse_lengths(const PulseLine& line, std::int32_t beats, int split);

/// Projects `from`, inside 0 and the limit, along the line in `beats`; speeds above `end_q32` are
/// cut off. False if no speed can be reached.
bool pulse_reach(const PulseLine& line, const SpeedInterval& from, std::int32_t beats, int split,
                 std::int64_t end_q32, SpeedInterval& to);

/// Fewest beats, `least` to `most`, for which pulse_reach() finds a speed with some split; 0 =
/// none. A `hint` close to the result makes the search faster.
std::int32_t fewest_pulse_beats(const PulseLine& line, const SpeedInterval& from,
                                std::int64_t end_q32, std::int32_t least, std::int32_t most,
                                std::int32_t hint);

}  // namespace lamplock::motion
