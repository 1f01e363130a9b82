// Lines of a program and the corners between them, for the line planner.
//
// In:  displacements, the machine's limits, the junction deviation.
// Out: per line its length, direction and the limits along it; per corner the square of the highest
//      speed through it.
// Who: the line planner, once or a few times per line pushed.
//
// A corner is passed as if on a circle that touches both lines, at the speed at which the axes'
// acceleration keeps it on the circle. The distance of the circle from the corner is at most the
// junction deviation, and it touches at the latest in the middle of the shorter line. On a curve of
// short lines the second rule makes it the circle of the curve itself, so dense points keep their
// speed; between long lines the first rule limits. Where an axis may jump in speed (speed_jump), a
// corner is passed as fast as that allows, if it is more.
//
// The numbers of a program are rounded, which bends a straight line: a change of direction of up to
// r (1/l + 1/l') on every axis is noise and is subtracted. Places have a resolution of 1/16 step,
// at worst (line/place.hpp), and programs are rounded to 1/1000 inch, at worst; but the machine
// cannot show less than a step, so r is the sum of both and a step at most. Coarse machines use
// less than a step: a step would be the turn of a small circle there. A turn of more than a right
// angle is not rounding. line/chords.hpp finds the turns that are lost between short lines.
#pragma once

#include <cstdint>

#include "firmware/motion/line/place.hpp"
#include "firmware/motion/line/real.hpp"
#include "firmware/motion/line/rise.hpp"
#include "firmware/motion/profile/limits.hpp"

namespace lamplock::motion {

/// Limits of one axis along a line that only it moves, in lengths of the line planner and ticks.
struct LineAxis {
  UFloat unit;      ///< length of a step; 1 for the coarsest axis
  UFloat rounding;  ///< error of a way that the rounding of its ends may cause
  UFloat speed;
  UFloat accel;
  UFloat jump;
  UFloat per_speed, per_accel;  ///< 1 / speed, 1 / accel, rounded up
  std::uint32_t weight_q31 = 0;
};

struct LineLimits {
  int axes = 0;
  LineRise rise;  ///< how accelerations rise, the same for every line
  PerAxis<LineAxis> axis{};
  UFloat um_min;            ///< speed of 1 um/min
  UFloat deviation;         ///< junction deviation
  UFloat rounding;          ///< maximum of all axes
  std::uint32_t um_q8 = 0;  ///< length of 1 um, Q8
  /// Minimum ticks of a line on the average of many, so that planning keeps ahead: of one that is
  /// joined to the line before it, and of any other; 0 = no minimum.
  std::uint32_t joined_line_ticks = 0, line_ticks = 0;
};
/// `coarsest_milli`: thousandths of steps/mm of the axis with the fewest. The limits are those that
/// hold at every tick; the beat of `limits` does not matter.
LineLimits make_line_limits(const Limits& limits, std::int32_t coarsest_milli,
                            std::uint32_t deviation_nm);

/// Length and direction of a displacement.
struct LineShape {
  UFloat length;      ///< 0 = no displacement
  UFloat per_length;  ///< 1 / length
  PerAxis<std::int32_t> cosine_q30{};
};
LineShape make_shape(const WayParts& way, const LineLimits& limits);
/// Its length alone.
UFloat length_of(const WayParts& way, const LineLimits& limits);

/// Limits of the axes along a direction.
struct LineBounds {
  UFloat speed;
  UFloat accel;
};
LineBounds make_bounds(const LineShape& shape, const LineLimits& limits);

struct LineCorner {
  UFloat speed_2;      ///< square of the highest speed through it; 2^40 or more = no limit
  bool clear = false;  ///< it turns by far more than rounding can
};
LineCorner corner_of(const LineShape& from, const LineShape& to, const LineLimits& limits);
/// Which turns are those of a curve.
enum class LineBends : std::uint8_t {
  any,
  gentle  ///< up to 0.7: beyond, the circle of shorter chords is nearer to the curve
};
/// The same for the circle that touches both only in the middle: the curvature.
UFloat curve_speed_2(const LineShape& from, const LineShape& to, LineBends bends,
                     const LineLimits& limits);

}  // namespace lamplock::motion
