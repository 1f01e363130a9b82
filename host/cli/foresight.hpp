// How long a job on a real machine still takes, known before it has begun: by its estimate, not by
// its pace so far.
//
// In:  the job, how many targets are done. Out: seconds. Who: run_job. Holds, missed flashes and
//      other job speeds are not foreseen; what is left is right again behind them, but for the
//      speed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/job/job.hpp"

namespace lamplock::cli {

/// The course of one job.
class Foresight {
 public:
  /// Knows nothing.
  Foresight() = default;
  /// Estimates the job from target `first` on; a job that cannot be estimated is one of which
  /// nothing is known.
  Foresight(const job::Job& job, std::size_t first, std::uint32_t job_speed);

  /// Seconds from target `done` (not done yet) to the end; nothing where that is not known.
  std::optional<double> left_s(std::size_t done) const;

 private:
  std::size_t first_ = 0;
  double beat_s_ = 0;
  std::vector<std::uint32_t> beat_;  ///< of each target, from the first shot
};

}  // namespace lamplock::cli
