// Ends a job on a simulated board whose lamp the machine cannot follow: the job would never end.
//
// In:  the sender and machine time, at every step. Out: nothing, or an Error.
// Who: run_job, for simulated boards. At a real machine the user checks the lamp.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {
class JobSender;
}  // namespace lamplock::link

namespace lamplock::run {

/// Watches one job of points that keeps to the beat of a lamp. Time counts from the last flash that
/// was of use.
class LockTimeout {
 public:
  explicit LockTimeout(const settings::Values& values);

  /// To be called after every step of the sender. Throws Error(job_failed) when most beats of a
  /// long time were lost by the lamp and nothing was fired.
  void poll(const link::JobSender& sender, std::chrono::microseconds now);

 private:
  /// What had been counted at a time.
  struct Count {
    std::uint64_t lost = 0, all = 0;
  };
  static Count count(const wire::Status& status);

  std::chrono::microseconds patience_;
  std::chrono::microseconds since_{};
  std::size_t points_ = 0;
  std::uint32_t shots_ = 0;
  bool begun_ = false;
  Count before_;
};

}  // namespace lamplock::run
