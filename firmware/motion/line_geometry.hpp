// Lines of a program and the corners between them, for the line planner.
//
// In:  displacements, the machine's limits, the junction deviation.
// Out: per line its length, direction and what the axes allow along it; per corner the square of
//      the highest speed through it.
// Called by the line planner, once or a few times per line pushed.
//
// A corner is passed as if on a circle that touches both lines, at the speed at which the axes'
// acceleration holds it on the circle. The circle passes the corner no further than the junction
// deviation, and touches no later than in the middle of the shorter line. On a curve of short
// lines the second makes it the circle of the curve itself, so dense points keep their speed; the
// first is what counts between long lines. Where an axis may jump in speed (speed_jump), a corner
// is passed as fast as that allows, if it is more.
//
// The numbers of a program are rounded, so that a straight line comes out bent: a change of
// direction of up to r (1/l + 1/l') on every axis says nothing and is taken off. Places are kept to
// 1/16 step, at worst (line_place.hpp), and who writes a program rounds to 1/1000 inch, at worst;
// but what is less than a step no machine shows, so r is the sum of both and a step at most. Coarse
// machines have less than a step: there it would be the turn of a small circle. A
// turn of more than a right angle is no rounding. What is lost between short lines is seen by
// line_chords.hpp.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/line_place.hpp"
#include "firmware/motion/line_real.hpp"
#include "firmware/motion/line_rise.hpp"

namespace lamplock::motion {

/// Limits of one axis along a line that only it moves, in lengths of the line planner and ticks.
struct LineAxis {
  LineReal unit;      ///< length of a step; 1 for the coarsest axis
  LineReal rounding;  ///< by so much a way may be off for the numbers that told its ends
  LineReal speed;
  LineReal accel;
  LineReal jump;
  LineReal per_speed, per_accel;  ///< 1 / speed, 1 / accel, rounded up
  std::uint32_t weight_q31 = 0;
};

struct LineLimits {
  int axes = 0;
  LineRise rise;  ///< how accelerations rise, the same for every line
  PerAxis<LineAxis> axis{};
  LineReal um_min;     ///< speed of 1 um/min
  LineReal deviation;  ///< junction deviation
  LineReal rounding;   ///< the most of any axis
  /// 1 / ticks that `paced_lines` lines take at least, for whoever plans has to keep ahead; 0 =
  /// any.
  LineReal per_pace;
};
/// Power of two.
inline constexpr int paced_lines_log2 = 3;

/// `coarsest_milli`: thousandths of steps/mm of the axis with the fewest. The limits are those that
/// hold at every tick; the beat they were made for does not matter.
LineLimits make_line_limits(const Limits& limits, std::int32_t coarsest_milli,
                            std::uint32_t deviation_nm);

/// Length and direction of a displacement.
struct LineShape {
  LineReal length;      ///< 0 = no way at all
  LineReal per_length;  ///< 1 / length
  PerAxis<std::int32_t> cosine_q30{};
};
LineShape make_shape(const WayParts& way, const LineLimits& limits);

/// What the axes allow along a direction.
struct LineBounds {
  LineReal speed;
  LineReal accel;
};
LineBounds make_bounds(const LineShape& shape, const LineLimits& limits);

/// Square of the highest speed through a corner. Any speed is 2^40 or more.
LineReal corner_speed_2(const LineShape& from, const LineShape& to, const LineLimits& limits);
/// Which turns are those of a curve.
enum class LineBends : std::uint8_t {
  any,
  gentle  ///< up to 0.7: beyond, the circle of shorter chords is nearer to the curve
};
/// The same of the circle that touches both in the middle alone: how a curve bends.
LineReal curve_speed_2(const LineShape& from, const LineShape& to, LineBends bends,
                       const LineLimits& limits);

}  // namespace lamplock::motion
