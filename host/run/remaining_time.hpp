// The time that a job on a real machine still takes: from its plan, not from its pace so far.
//
// In:  the job, how many targets or lines are done, the job speed. Out: seconds. Who: run_job.
//
// Another job speed is another plan, because lamp, corners and rapids do not become faster with it.
// It begins at the first point that the board has not planned yet: those before it are fired at the
// old speed. The rest of the job is planned in the background; until that is done, the time of the
// old plan after this point is scaled by the speeds. Holds and missed flashes are not planned;
// after them the rest is right again.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/job/job.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/transport.hpp"
#include "host/run/background.hpp"

namespace lamplock::run {

/// The remaining time of one job.
class RemainingTime {
 public:
  /// Without a plan.
  RemainingTime() = default;
  /// Plans the job, with its own settings, from target or line `first` on; a job that cannot be
  /// planned has no known rest.
  RemainingTime(job::Job job, std::size_t first, std::uint32_t job_speed);
  /// Ends a plan that is being made.
  ~RemainingTime();
  RemainingTime(const RemainingTime&) = delete;
  RemainingTime& operator=(const RemainingTime&) = delete;

  /// The time of another plan is scaled until this ends.
  bool is_planning() const { return next_.is_busy(); }
  /// Seconds from target or line `done` (not done yet) to the end at a job speed in percent;
  /// nothing where that is not known. Never waits for a plan.
  std::optional<double> left_s(std::size_t done, std::uint32_t job_speed);

 private:
  /// Seconds to the end of the job before each item, from item `first` on; empty: not known.
  struct Plan {
    std::uint32_t job_speed = 0;
    std::size_t first = 0;
    std::vector<float> left_s;
    std::optional<double> at(std::size_t done) const;
  };
  void adopt(Plan made);
  std::optional<double> planned_s(std::size_t done) const;
  std::size_t first_not_planned(std::size_t done) const;
  static Plan plan_of(const job::Job& job, std::size_t first, std::uint32_t job_speed,
                      const std::atomic<bool>& is_cancelled);
  static Plan plan_points(const job::Job& job, std::size_t first, std::uint32_t job_speed,
                          const std::atomic<bool>& is_cancelled);
  static Plan plan_rows(const job::Job& job, std::uint32_t job_speed);

  std::shared_ptr<const job::Job> job_;
  std::atomic<bool> is_cancelled_{false};  ///< before plans_, whose making reads it
  std::vector<Plan> plans_;                ///< each is valid up to the first item of the next one
  Background<Plan> next_;                  ///< the last member: it ends before the others
};

/// The settings that a machine runs a job with: its own speeds and lamp, then the overrides of the
/// job; all others are those that the job was made for.
settings::Values settings_in_job(const job::Job& job, const link::BoardSettings& machine);

/// The job with the settings of the machine at a port. A machine that does not report them is taken
/// for the one that the job was made for.
job::Job job_on_machine(const job::Job& job, link::Transport& port);

}  // namespace lamplock::run
