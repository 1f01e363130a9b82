// Plans a whole job of points with the firmware's planner, without a machine.
//
// In:  a job, the conditions of its plans (ticks, job speed), the first point.
// Out: every move of the plan, in order: its point, its beats, whether it ends with a shot.
// Who: the estimate (estimate.hpp). Budget: a million points of a cloud in 10 s.
//
// Windows are cut and planned by the same classes as on the machine (in
// machine/runners: next_window.hpp, window_plan.hpp), with the input that they get from the job
// runner when no point is missed, no hold occurs and the host is never late. The plan then depends
// on the points only and is the same as the machine's. It has no clock: jobs in which the machine
// waits for shutter or attenuator between two points cannot be planned here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "firmware/machine/runners/window_plan.hpp"
#include "host/job/job.hpp"
#include "shared/beat.hpp"

namespace lamplock::estimate {

/// One move of a plan: from the point before, or for another flash at the same one.
struct Way {
  std::uint32_t point = 0;                 ///< index in the job
  std::int32_t beats = 0;                  ///< at least 1
  bool shot = false;                       ///< its last beat has one
  std::uint32_t ticks = 0;                 ///< nominal length
  std::uint32_t tick_q16 = full_tick_q16;  ///< length of these ticks over the nominal one
};

/// Options of a plan.
struct PlanOptions {
  machine::PlanPace pace;      ///< of the runner at the begin of the job (JobRunner::plan_pace())
  std::size_t first = 0;       ///< point to begin with
  std::int32_t min_beats = 1;  ///< between two shots
};

/// Called with every move of a plan.
using SeeWay = std::function<void(const Way&)>;

/// Plans a job of points from its first point to its last. Throws Error(bad_input) for a point
/// that the machine cannot reach.
void plan_job(const job::Job& job, const PlanOptions& options, const SeeWay& see);

/// True if the machine must wait for shutter or attenuator between any two points.
bool waits_for_beam(const job::Job& job);

}  // namespace lamplock::estimate
