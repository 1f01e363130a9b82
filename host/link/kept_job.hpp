// A job whose progress is stored in a journal, so that it can continue after any interruption.
//
// In:  the job as it was made, the journal, a board to ask; the progress of the sender.
// Out: where the job continues; records of the journal.
// Who: the commands that run jobs of points and of rows on a real board.
//
//   require_ended() or find() -> begin_at() -> keep(options of a JobSender) -> finish(its result)
//
// The board is asked first: if it still has the session of the last run, or has marked a restart
// during it, its number is exact. Otherwise the journal bounds the points that may have been fired.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "host/job/job.hpp"
#include "host/job/progress_journal.hpp"
#include "host/link/continuation.hpp"
#include "host/link/sender.hpp"
#include "host/link/transport.hpp"

namespace lamplock::link {

/// One job and its journal.
class KeptJob {
 public:
  /// The job must outlive this object. It must be as it was made, without later changes by a run.
  KeptJob(const std::filesystem::path& journal, const job::Job& job);

  /// Throws Error(bad_input) if the last run of this job has no known end: a new start would fire
  /// points twice.
  void require_ended() const;
  /// Where the last run of this job was stopped, the first point or line not done; empty if it was
  /// completed, never begun, or has no known end.
  std::optional<std::size_t> stopped_at() const;
  /// Returns where to continue the last run, and records it; stops this run if the board still
  /// executes it. Throws Error: bad_input (no run, another job), and as JobInquiry::end_job().
  Continuation find(Transport& port);
  /// The next run begins at this item, `fired` flashes of which were fired before.
  void begin_at(std::size_t from, std::uint32_t fired) {
    from_ = static_cast<std::uint32_t>(from);
    fired_ = fired;
  }
  /// Makes a sender with these options record its progress.
  void keep(SenderOptions& options);
  /// Records the end of the run. The journal of a completed job is removed.
  void finish(const JobResult& result);

  const std::filesystem::path& file() const { return journal_.file(); }

 private:
  void note(const JobProgress& progress);
  job::JournalContents read() const;
  Continuation rest_of(const job::KeptRun& run, const wire::Status& status,
                       const std::optional<RestartMark>& mark) const;
  Continuation reported_by_board(const job::KeptRun& run, const wire::Status& status) const;
  void append(job::Progress progress, const Continuation& rest);

  job::ProgressJournal journal_;
  const job::Job& job_;
  std::uint32_t hash_;
  std::uint32_t session_ = 0;  ///< of the recorded run; 0 = not offered to the board yet
  std::uint32_t from_ = 0, fired_ = 0;
};

}  // namespace lamplock::link
