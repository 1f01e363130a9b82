// A whole job of points planned by the firmware's planner, without a machine.
//
// In:  a job, how the machine stood when it was begun (its ticks), from which point on.
// Out: every way of the plan, in order: which point, how many beats, whether it ends with a shot.
// Who: the estimate (estimate.hpp). Budget: a million points of a cloud in 10 s.
//
// Windows are cut and planned by the same classes as on the machine (machine/next_window.hpp,
// machine/window_plan.hpp), fed as the job runner feeds them when no point is missed, no hold comes
// and the host is never late. A plan depends on the points alone then, so this one is the one that
// the machine will make. Nothing here knows what time it is: a machine that has to stand for
// shutter or attenuator between two points is not planned here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "host/job/job.hpp"
#include "shared/beat.hpp"

namespace lamplock::estimate {

/// How the machine stands when it makes its first plan.
struct Standing {
  std::uint32_t shortest_tick_q16 = full_tick_q16;  ///< to expect, over the nominal one
  std::uint32_t longest_tick_q16 = full_tick_q16;   ///< that may be planned for
};

/// One way of a plan: from the point before, or for another flash at the same one.
struct Way {
  std::uint32_t point = 0;                 ///< index in the job
  std::int32_t beats = 0;                  ///< at least 1
  bool shot = false;                       ///< its last beat has one
  std::uint32_t ticks = 0;                 ///< nominal length
  std::uint32_t tick_q16 = full_tick_q16;  ///< length of these ticks over the nominal one
};

/// What a job is planned with.
struct PlanOptions {
  Standing standing;
  std::size_t first = 0;          ///< point to begin with
  std::uint32_t job_speed = 100;  ///< percent
  std::int32_t least_beats = 1;   ///< between two shots
};

/// Sees every way of a plan.
using SeeWay = std::function<void(const Way&)>;

/// Plans a job of points from its first point to its last. Throws Error(bad_input) for a point
/// that the machine cannot reach.
void plan_job(const job::Job& job, const PlanOptions& options, const SeeWay& see);

/// True if the machine has to stand for shutter or attenuator somewhere between two points.
bool waits_for_beam(const job::Job& job);

}  // namespace lamplock::estimate
