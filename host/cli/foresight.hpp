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
#include "host/link/board_settings.hpp"
#include "host/link/transport.hpp"

namespace lamplock::cli {

/// The course of one job.
class Foresight {
 public:
  /// Knows nothing.
  Foresight() = default;
  /// Estimates the job, with its own settings, from target `first` on; a job that cannot be
  /// estimated is one of which nothing is known.
  Foresight(const job::Job& job, std::size_t first, std::uint32_t job_speed);

  /// Seconds from target `done` (not done yet) to the end; nothing where that is not known.
  std::optional<double> left_s(std::size_t done) const;

 private:
  std::size_t first_ = 0;
  double beat_s_ = 0;
  std::vector<std::uint32_t> beat_;  ///< of each target, from the first shot
};

/// Settings that a machine runs a job with: speed and lamp as it has told, then what the job
/// states; all else is as the job was made for.
settings::Values settings_in_job(const job::Job& job, const link::BoardSettings& machine);

/// Asks the machine at a port for its settings and foresees the job on it. A machine that does not
/// tell is taken for the one that the job was made for.
Foresight foresee(const job::Job& job, link::Transport& port, std::size_t first,
                  std::uint32_t job_speed);

}  // namespace lamplock::cli
