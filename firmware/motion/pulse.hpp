// Motion with limited jerk: pulses instead of steps of acceleration, and brakes.
//
// In:  profiles with phases of constant acceleration (profile.hpp), the limits of an axis.
// Out: the same with ramps (segment.hpp): each phase becomes a pulse over the same ticks that
//      changes the speed as much. By its symmetry it also goes equally far, so that everything
//      known about the ends of the phase stays true. Brakes to rest, with and without jerk.
// Called by the planner (main loop, or the core that plans), once or a few times per axis and
// segment; brakes also by the job runner (main loop), with what is handed out and to hold.
//
// What is kept: over any time t the acceleration changes by no more than J t and one stair, which
// is what J gives in `least_stair_ticks` or in a quarter of a ramp, whichever is more. What J gives
// in half the shortest stair begins and ends at once; a ramp is never further from a straight one
// than half a stair and has its speed at the end of every stair.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/profile.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// Gives both phases of a profile, made without ramps, the shortest ramps that keep the jerk;
/// `v1_q62` is the speed that it ends with. False if a phase is too short for any: n^2 J / 4 is the
/// most that a pulse of n ticks can change a speed by.
bool make_pulses(AxisProfile& profile, std::int64_t v1_q62, std::int64_t jerk_q78);

/// The same for all axes of a straight line, whose phases are equally long: with ramps as long as
/// the axis needs that needs the longest, so that they stay on the line. Leaves phases without
/// ramps where they are too short for some axis.
bool make_pulses(PerAxis<AxisProfile>& profiles, const PerAxis<std::int64_t>& v1_q62,
                 const Limits& limits);

/// True if no ramp is steeper than `jerk_q78` (0 = not limited).
bool keeps_jerk(const AxisProfile& profile, std::int64_t jerk_q78);

/// Lengths of phases to try where those of the quietest profile are too short for pulses.
inline constexpr std::uint32_t phase_choices = 10;
AxisProfile make_choice(std::uint32_t choice, Int128 distance_q62, std::int64_t v0_q62,
                        std::int64_t v1_q62, std::uint32_t ticks);

/// Highest speed that a brake takes away over a way where jerk is limited, normalised and scaled:
/// at most the limit, (v^2 + v t) / 2 = way with the time t in which the acceleration rises.
std::int32_t pulse_braking_speed_qs(const AxisLimits& axis, std::uint32_t beat_ticks,
                                    std::int64_t steps);

/// Ticks in which an axis brakes to rest from a speed and no acceleration; on average at half the
/// speed.
std::uint32_t brake_ticks(std::int64_t v0_q62, const AxisBrake& axis);

/// Accelerations of the axes where something is broken off, of ramps the straight ones.
using Accelerations = PerAxis<std::int64_t>;

/// Segment that brakes every axis from `from` at its limit, to rest. Where jerk is limited an axis
/// first brings its acceleration to zero, or to rest with it if it brakes already; its profile may
/// end before the segment.
stepper::Segment make_brake(const stepper::MotionState& from, const BrakeLimits& limits,
                            const Accelerations& accel_q62 = {});

/// True if a segment stays inside the work space. One that is broken off can brake later than it
/// was planned to if its jerk is limited.
bool stays_inside(const stepper::Segment& segment, const stepper::MotionState& from,
                  const BrakeLimits& limits);

}  // namespace lamplock::motion
