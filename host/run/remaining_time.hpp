// The time that a job on a real machine still takes: from its estimate, not from its pace so far.
//
// In:  the job, how many targets are done. Out: seconds. Who: run_job. Holds, missed flashes and
//      other job speeds are not estimated; after holds and missed flashes
//      the rest is right again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/job/job.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/transport.hpp"

namespace lamplock::run {

/// The remaining time of one job.
class RemainingTime {
 public:
  /// Without an estimate.
  RemainingTime() = default;
  /// Estimates the job, with its own settings, from target `first` on; a job that cannot be
  /// estimated has no known rest.
  RemainingTime(const job::Job& job, std::size_t first, std::uint32_t job_speed);

  /// Seconds from target `done` (not done yet) to the end; nothing where that is not known.
  std::optional<double> left_s(std::size_t done) const;

 private:
  std::size_t first_ = 0;
  double beat_s_ = 0;
  std::vector<std::uint32_t> beat_;  ///< of each target, from the first shot
};

/// The settings that a machine runs a job with: its own speeds and lamp, then the overrides of the
/// job; all others are those that the job was made for.
settings::Values settings_in_job(const job::Job& job, const link::BoardSettings& machine);

/// Asks the machine at a port for its settings and estimates the job on it. A machine that does not
/// report them is taken for the one that the job was made for.
RemainingTime remaining_time(const job::Job& job, link::Transport& port, std::size_t first,
                             std::uint32_t job_speed);

}  // namespace lamplock::run
