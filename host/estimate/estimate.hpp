// Predicts beats and duration of a job before it is engraved: the same numbers as the report of its
// run.
//
// In:  a job of points. Out: beats, time, beats by reason, the beat of every shot.
// Who: `lamplock estimate`, tests.
//
//   virtual board --- up to the first shot ---> beats before it, length of the ticks
//   firmware's planner --- the whole job -----> beats from the first shot to the last
//
// The start depends on lock and link, so the job is begun on the virtual board with an ideal lamp,
// and left after the first shot. After that a machine without delays, holds and missed flashes
// follows the plan exactly, and the planner is called directly (job_plan.hpp), many times faster
// than a board runs. Jobs in which the machine waits for shutter or attenuator between points are
// run on the virtual board to their end: slower, with the same accuracy.
//
// Not included: holds, missed flashes, changes of the job speed, a late host. A job faster than its
// link (points a second: docs/wire-format.md) takes longer than estimated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/job/job.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::estimate {

/// Part of the job to estimate.
struct EstimateOptions {
  std::string input = "job";      ///< name of the job in errors
  std::size_t first = 0;          ///< point to begin with
  std::uint32_t fired = 0;        ///< flashes of this point that were fired in earlier runs
  std::uint32_t job_speed = 100;  ///< percent
  /// Called now and then with the number of points planned.
  std::function<void(std::size_t)> progress{};
};

/// The predicted result of a run.
struct Estimate {
  std::uint64_t shots = 0;
  std::uint64_t beats = 0;          ///< lamp periods from the first shot to the last, both included
  std::uint64_t beats_before = 0;   ///< lamp periods before the first shot: lock and approach
  BeatsByReason beats_by_reason{};  ///< of `beats`
  double time_s = 0;                ///< machine time of `beats`
  double time_before_s = 0;         ///< machine time before, from the moment the job is sent
  std::vector<std::uint32_t> beat_of_shot;  ///< in order, from the first shot, which has 0
};

/// Estimates a job of points. Throws Error(bad_input) if there is no point `first`, and the errors
/// of a run if the machine refuses the job or cannot reach a point.
Estimate estimate_job(const job::Job& job, const EstimateOptions& options = {});

}  // namespace lamplock::estimate
