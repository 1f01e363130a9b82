// The job that runs, in a file beside those of the server. A server that is killed leaves the file,
// so that the next one can say how far the job was.
//
// In:  the job that clients see. Out: the file; the job of a server that was killed.
// Who: the server, in its thread; the file is written outside of it.
#pragma once

#include <filesystem>
#include <optional>

#include "host/run/background.hpp"
#include "host/serve/clock.hpp"
#include "host/serve/machine_view.hpp"

namespace lamplock::serve {

class RunningJob {
 public:
  explicit RunningJob(const std::filesystem::path& folder) : file_(folder / ".running.json") {}

  /// The job that a server before has left, once: its end is "interrupted", its message says how to
  /// continue. A file that cannot be read counts as none.
  std::optional<EndedJob> take_left() const;
  /// Writes the job if it has changed, at most once a second; removes the file when it has ended.
  /// To be called regularly.
  void note(const JobView& job, Clock::time_point now);
  /// Removes the file, of a server that ends by itself.
  void end();

 private:
  std::filesystem::path file_;
  JobView noted_{};
  std::chrono::system_clock::time_point begun_{};
  Clock::time_point written_at_{};
  run::Background<bool> writing_{};
};

}  // namespace lamplock::serve
