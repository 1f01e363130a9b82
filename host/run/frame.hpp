// Runs round the bounds of an object with firing disabled, at the height of its top.
//
// In:  a request, a speed, where to run it. Out: the box, the outcome. Who: `frame`.
#pragma once

#include "host/geometry/bounds.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepare_job.hpp"

namespace lamplock::run {

/// Slow enough to watch.
inline constexpr double default_frame_speed_m_s = 0.05;

struct Framed {
  geometry::Bounds box;
  JobOutcome outcome;
};

/// No axis exceeds `speed_m_s` or its own limit. Throws Error where nothing was done.
Framed frame(const JobRequest& request, double speed_m_s, BoardOptions options, Frontend& frontend);

}  // namespace lamplock::run
