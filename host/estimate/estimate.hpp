// What a job will take, before it is engraved: the same numbers as the report of its run.
//
// In:  a job of points. Out: beats, time, beats by reason, the beat of every shot.
// Who: `lamplock estimate`, tests.
//
//   virtual board --- up to the first shot ---> beats before it, length of the ticks
//   firmware's planner --- the whole job -----> beats from the first shot to the last
//
// The start depends on lock and link, so the job is really begun, on the virtual board with an
// ideal lamp, and left when it has fired. From there on a machine that is never late, never held
// and never misses does what the planner says, and the planner is asked directly (job_plan.hpp),
// many times faster than any board runs. Jobs in which the machine stands for shutter or attenuator
// between points are run on the virtual board to their end: slower, as exact.
//
// Not foreseen: holds, missed flashes, another job speed on the way, a host that comes late. A job
// faster than its link (points a second: docs/wire-format.md) takes longer than estimated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/job/job.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::estimate {

/// What is estimated.
struct EstimateOptions {
  std::size_t first = 0;          ///< point to begin with
  std::uint32_t fired = 0;        ///< flashes of it fired before, not among those of the job
  std::uint32_t job_speed = 100;  ///< percent
  /// Told now and then how many points are planned.
  std::function<void(std::size_t)> progress{};
};

/// What a run will say.
struct Estimate {
  std::uint64_t shots = 0;
  std::uint64_t beats = 0;          ///< lamp periods from the first shot to the last, both included
  std::uint64_t beats_before = 0;   ///< lamp periods before the first shot: lock and approach
  BeatsByReason beats_by_reason{};  ///< of `beats`
  double time_s = 0;                ///< machine time of `beats`
  double time_before_s = 0;         ///< machine time before, from the moment the job is sent
  std::vector<std::uint32_t> beat_of_shot;  ///< in order, from the first shot, which has 0
};

/// Estimates a job of points. Throws Error(bad_input) if there is none at `first`, and what a run
/// would throw where the machine refuses the job or cannot reach a point.
Estimate estimate_job(const job::Job& job, const EstimateOptions& options = {});

}  // namespace lamplock::estimate
