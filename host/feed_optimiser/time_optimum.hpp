// The exact time optimum of a jerk-limited single axis from rest to rest.
//
// In:  a distance, limits of speed, acceleration and jerk. Out: the least time.
// Who: the table of `lamplock jerk`; the check that a block is longer than a control period.
//
// Up to seven phases of constant jerk, see L. Biagiotti, C. Melchiorri, "Trajectory Planning for
// Automatic Machines and Robots", section 3.4 (double S).
#pragma once

#include "host/feed_optimiser/limits.hpp"

namespace lamplock::feed_optimiser {

/// Seconds for `length_mm`.
double optimum_s(double length_mm, const PathLimits& limits);

}  // namespace lamplock::feed_optimiser
