// Converts two states and a number of ticks to a motion that the tick generator can run.
//
// In:  displacement and both end speeds of one axis, the ticks between, its limits.
// Out: a profile of up to three phases with the least peak acceleration, exact in position to
//      better than 1e-6 step (the rest is carried into the next segment) and exact in end speed.
// Who: the planner (main loop, or the core that plans), once per axis and segment.
//
// With e = d - (v0 + v1) t/2 and w = v1 - v0 two phases of equal and opposite acceleration need
// A = (2|e| + sqrt(4 e^2 + w^2 t^2)) / t^2; a cruise phase is put between them where the speed
// would pass its limit.
#pragma once

#include <cstdint>

#include "firmware/motion/profile/limits.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

using stepper::AxisProfile;

/// Profile over `ticks` >= 2 covering `distance_q62` from `v0_q62` to `v1_q62` (steps per tick),
/// cruising at no more than `speed_q62`. Does not check limits: see within_limits().
AxisProfile make_profile(Int128 distance_q62, std::int64_t v0_q62, std::int64_t v1_q62,
                         std::uint32_t ticks, std::int64_t speed_q62);

/// Constant speed all the way, if both end speeds equal it except for the last bits: it ends at its
/// start speed, with a distance error far below that of a profile. False if they do not.
bool make_cruise(Int128 distance_q62, std::int64_t v0_q62, std::int64_t v1_q62, std::uint32_t ticks,
                 AxisProfile& profile);

/// The profile of the least excursion: ramps at full acceleration to a steady speed and from there,
/// so that it exceeds the interval between start and end only by the braking distance. In
/// normalised units (reach.hpp): the steady speed of a feasible way, `q_q32` in `beats` from
/// `v0_q32` to `v1_q32`.
std::int64_t steady_speed_q32(std::int64_t q_q32, std::int64_t v0_q32, std::int64_t v1_q32,
                              std::int32_t beats);
/// That profile over `ticks`, its ramps about as long as given and no steeper than `accel_q62`.
AxisProfile make_steady_profile(Int128 distance_q62, std::int64_t v0_q62, std::int64_t v1_q62,
                                std::uint32_t ticks, std::uint32_t lead_ticks,
                                std::uint32_t tail_ticks, std::int64_t accel_q62);

/// Profile with given lengths of the phases, all at least one tick except the cruise; the cruise
/// speed follows from the distance. Does not check limits.
AxisProfile make_phases(Int128 distance_q62, std::int64_t v0_q62, std::int64_t v1_q62,
                        std::uint32_t lead_ticks, std::uint32_t cruise_ticks,
                        std::uint32_t tail_ticks);

/// Finds the reversals of the axis; to be called after a profile was changed.
void set_turns(AxisProfile& profile);

/// Profile that brakes from `v0_q62` to rest at `accel_q62` and then rests, `ticks` in all. `ticks`
/// >= braking_ticks(v0_q62, accel_q62).
AxisProfile make_brake(std::int64_t v0_q62, std::int64_t accel_q62, std::uint32_t ticks);

/// Minimum number of ticks to brake to rest.
std::uint32_t braking_ticks(std::int64_t v0_q62, std::int64_t accel_q62);

/// True if neither speed nor acceleration exceeds its limit at any tick.
bool within_limits(const AxisProfile& profile, std::int64_t speed_q62, std::int64_t accel_q62);

/// Lowest and highest position of a profile relative to its start, steps, exact.
struct Excursion {
  Int128 low_q62;
  Int128 high_q62;
};
Excursion excursion(const AxisProfile& profile);

}  // namespace lamplock::motion
