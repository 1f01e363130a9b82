// A job whose progress is kept in a journal, so that it goes on after any end.
//
// In:  the job as it was made, the journal, a board to ask; how far the sender is.
// Out: where to go on; records of the journal.
// Who: the commands that run jobs of points and of rows on a real board.
//
//   require_ended() or find() -> begin_at() -> keep(options of a JobSender) -> finish(its result)
//
// The board is asked first: if it still knows the session of the last run, or has marked its
// restart in it, its number is exact. Otherwise the journal bounds what may have been fired.
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
  /// The job must outlive this and be as it was made: what a run changes in it comes later.
  KeptJob(const std::filesystem::path& journal, const job::Job& job);

  /// Throws Error(job_failed) if the last run of this job has no known end: begun anew, the job
  /// would fire points twice.
  void require_ended() const;
  /// Returns where to continue the last run, and records it; what is left of the run on the board
  /// is stopped. Throws Error: bad_input (no run, another job), and as JobInquiry::end_job().
  Continuation find(Transport& port);
  /// The next run begins at this item, `fired` flashes of which were fired before.
  void begin_at(std::size_t from, std::uint32_t fired) {
    from_ = static_cast<std::uint32_t>(from);
    fired_ = fired;
  }
  /// From now on the sender with these options writes its progress.
  void keep(SenderOptions& options);
  /// Writes how the run has ended. The journal of a job that is done is removed.
  void finish(const JobResult& result);

  const std::filesystem::path& file() const { return journal_.file(); }

 private:
  void note(const JobProgress& progress);
  job::JournalContents read() const;
  Continuation rest_of(const job::KeptRun& run, const wire::Status& status,
                       const std::optional<RestartMark>& mark) const;
  Continuation told_by_board(const job::KeptRun& run, const wire::Status& status) const;
  void append(job::Progress progress, const Continuation& rest);

  job::ProgressJournal journal_;
  const job::Job& job_;
  std::uint32_t hash_;
  std::uint32_t session_ = 0;  ///< of the run that is being kept; 0 = not offered yet
  std::uint32_t from_ = 0, fired_ = 0;
};

}  // namespace lamplock::link
