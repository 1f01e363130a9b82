// Lines of a path and the corners between them.
//
// In:  displacements of all axes, the machine's limits.
// Out: per line its length, direction and limits along it; per corner the highest speed through it.
// Who: the path planner (main loop, or the core that plans), once per point of a window.
//
// All axes run a line in proportion, so one number describes the motion. It is normalised as in
// reach.hpp, by the axis that limits the acceleration along the line: time in beats, that axis'
// acceleration = 1; where jerk is limited the peak of its pulses (pulse_line.hpp) = 1. The speed
// that is continuous at a corner is the one in mm/s, so lengths are measured in millimetres,
// written as steps of the coarsest axis.
//
// The corner. At speed v an axis jumps by v |u' - u|, u and u' its direction cosines before and
// after the corner, and the jump may be at most its setting J. But points are rounded to whole
// steps: three points of a straight line form a corner if the middle one is up to one step beside
// the chord of the other two, on every axis. With lengths l and l' that is a change of direction of
// up to r = (1 step) (1/l + 1/l'). Such a change does not belong to the path, and following it does
// no harm: the axis stays within one step of where it would be without it. So
//
//   v (|u' - u| - r) <= J  and  v |u' - u| <= J + 2 steps/beat
//
// on every axis. A speed of one line in one beat makes 2 steps/beat of r at most, so the second
// rule limits only the entry from a long line into a much shorter one; it bounds every jump. With J
// = 0 a corner of more than rounding is a full stop, and a smaller one does not slow the machine.
//
// For the user: the setting holds for corners of the path itself; the jump at a motor is up to 2
// steps/beat more. A bend of points a step or two apart cannot be distinguished from rounding and
// is passed at those 2 steps/beat. Curves are limited by J and rounding at each point, not by the
// acceleration across several: with a point in every beat a radius of R is passed at v if J >= v^2
// beat / R. A path that reverses its direction, within rounding, stops for every J.
#pragma once

#include <cstdint>

#include "firmware/motion/path/real.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// What rounding may add to a speed jump: this many steps per beat, on every axis.
inline constexpr std::uint32_t rounding_jump_steps = 2;

/// A straight line from one target to the next.
struct PathLine {
  bool none = true;             ///< no displacement
  PerAxis<std::int32_t> way{};  ///< displacement / 2^shift steps
  int shift = 0;
  PerAxis<std::int32_t> cosine_q30{};  ///< in millimetres
  Real length;                         ///< in steps of the coarsest axis
  std::int64_t displacement_q32 = 0;   ///< normalised
  std::int64_t speed_q32 = 0;          ///< normalised limit
  std::int64_t rise_q32 = 0;           ///< beats in which the acceleration rises; 0 = at once
  std::int64_t flat_q32 = 0;           ///< share of it reached at once
};

/// The line of a displacement in steps. A line longer than max_displacement_q32 has a displacement
/// above it.
PathLine make_line(const PerAxis<std::int64_t>& steps_q32, const Limits& limits);

/// Factor from a normalised speed on `from` to the same speed on `to`; both have a length.
Real speed_factor(const PathLine& from, const PathLine& to);

/// Normalised speed on a line of a speed in steps of the coarsest axis per beat.
std::int64_t normalised_speed_q32(const PathLine& line, Real speed);

/// Highest speed through the corner between two lines that have a length, steps of the coarsest
/// axis per beat; 0 where the path reverses its direction.
Real corner_speed(const PathLine& from, const PathLine& to, const Limits& limits);

/// The same by the second rule only: for a corner of which only the directions are known.
Real jump_speed(const PathLine& from, const PathLine& to, const Limits& limits);

/// A line in the direction of a motion that is not at rest, and its `speed` in steps of the
/// coarsest axis per beat. Only its direction is set.
PathLine line_of_speed(const PerAxis<std::int64_t>& speed_q62, const Limits& limits, Real& speed);

/// Speed of every axis, steps per tick, for a normalised speed on a line.
PerAxis<std::int64_t> axis_speeds_q62(const PathLine& line, std::int64_t speed_q32,
                                      std::uint32_t beat_ticks);

}  // namespace lamplock::motion
