// Motion with limited jerk: pulses instead of steps of acceleration, and brakes.
//
// In:  profiles with phases of constant acceleration (profile.hpp), the limits of an axis.
// Out: the same with ramps (segment.hpp): each phase becomes a pulse over the same ticks that
//      changes the speed as much. By its symmetry it also covers the same distance, so that both
//      ends of the phase are unchanged. Brakes to rest, with and without jerk.
// Who: the planner (main loop, or the core that plans), once or a few times per axis and segment;
//      brakes also the job runner (main loop), after each part it hands out and for a hold.
//
// Guarantee: over any time t the acceleration changes by at most J t and one stair, which is the
// change by J in `min_stair_ticks` or in a quarter of a ramp, whichever is more. The change by J
// in half the shortest stair begins and ends at once; a ramp is within half a stair of a straight
// one and has its speed at the end of every stair.
#pragma once

#include <cstdint>

#include "firmware/motion/profile/limits.hpp"
#include "firmware/motion/profile/profile.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// Adds the shortest ramps that keep the jerk to both phases of a profile made without ramps;
/// `v1_q62` is its end speed. False if a phase is too short: a pulse of n ticks changes the speed
/// by at most n^2 J / 4.
bool make_pulses(AxisProfile& profile, std::int64_t v1_q62, std::int64_t jerk_q78);

/// The same for all axes of a straight line, whose phases are equally long: all ramps are as long
/// as the longest required by an axis, so that the axes stay on the line. Phases too short for some
/// axis get no ramps.
bool make_pulses(PerAxis<AxisProfile>& profiles, const PerAxis<std::int64_t>& v1_q62,
                 const Limits& limits);

/// True if no ramp is steeper than `jerk_q78` (0 = not limited).
bool keeps_jerk(const AxisProfile& profile, std::int64_t jerk_q78);

/// Lengths of phases to try where those of the quietest profile are too short for pulses.
inline constexpr std::uint32_t phase_choices = 10;
AxisProfile make_choice(std::uint32_t choice, Int128 distance_q62, std::int64_t v0_q62,
                        std::int64_t v1_q62, std::uint32_t ticks);

/// Highest speed from which a brake stops within a distance where jerk is limited, normalised and
/// scaled: at most the limit, (v^2 + v t) / 2 = distance with the time t in which the acceleration
/// rises.
std::int32_t pulse_braking_speed_qs(const AxisLimits& axis, std::uint32_t beat_ticks,
                                    std::int64_t steps);

/// Ticks in which an axis brakes to rest from a speed without acceleration; on average at half the
/// speed.
std::uint32_t brake_ticks(std::int64_t v0_q62, const AxisBrake& axis);

/// Accelerations of the axes where motion is interrupted; in ramps those of the straight ramp.
using Accelerations = PerAxis<std::int64_t>;

/// Segment that brakes every axis from `from` at its limit, to rest. Where jerk is limited an axis
/// first brings its acceleration to zero, or to rest with it if it brakes already; its profile may
/// end before the segment.
stepper::Segment make_brake(const stepper::MotionState& from, const BrakeLimits& limits,
                            const Accelerations& accel_q62 = {});

/// True if a segment stays inside the work space. If jerk is limited, an interrupted segment can
/// stop further out than planned.
bool stays_inside(const stepper::Segment& segment, const stepper::MotionState& from,
                  const BrakeLimits& limits);

}  // namespace lamplock::motion
