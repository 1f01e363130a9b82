// The journal of a job: the file from which the job goes on after host or board have lost power.
//
// In:  how far the job is, each time before more of it is handed to the board.
// Out: the file; what it says of the last run of the job.
// Who: link::KeptJob.
//
// A record is a line of text with a check sum, and is on the disk before append() returns. So a
// line that is torn or damaged at the end is about points that have not been handed to the board:
// it is ignored.
//
//   # kind session job first_unfired flashes may_have_fired check
//   begun 5eed0001 9f3c11aa 0 0 0 4d1f0a32
//   running 5eed0001 9f3c11aa 0 0 1024 90ab12cd
//   running 5eed0001 9f3c11aa 503 0 1527 77e01b5c
//   ended 5eed0001 9f3c11aa 687 0 687 0f3340aa
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::job {

struct Job;

/// What a record says that a run of a job has done.
enum class Progress : std::uint8_t {
  begun,  ///< the board is about to be offered the job; first_unfired and flashes: where it begins
  running,  ///< the record is a lower and an upper bound until the next one
  ended     ///< the board was at rest when it reported
};

struct ProgressRecord {
  Progress progress = Progress::begun;
  std::uint32_t session = 0;
  std::uint32_t job = 0;             ///< hash_of() the job
  std::uint32_t first_unfired = 0;   ///< all points, or lines, before it are fired
  std::uint32_t flashes = 0;         ///< of that point that are fired
  std::uint32_t may_have_fired = 0;  ///< no point from here on was handed to the board
  friend bool operator==(const ProgressRecord&, const ProgressRecord&) = default;
};

/// One run: how it began, and the last that is known of it.
struct KeptRun {
  ProgressRecord begun, last;
  friend bool operator==(const KeptRun&, const KeptRun&) = default;
};

/// What a journal says.
struct JournalContents {
  std::optional<KeptRun> run;             ///< the last one that the board has taken
  std::optional<ProgressRecord> offered;  ///< one begun after it, which the board may have taken
  bool empty() const { return !run && !offered; }
  friend bool operator==(const JournalContents&, const JournalContents&) = default;
};

/// Tells jobs apart: CRC-32 of the header and of all records.
std::uint32_t hash_of(const Job& job);

/// A record as its line, with the line end.
std::string progress_line(const ProgressRecord& record);

/// What the text of a journal says.
JournalContents contents_of(std::string_view text);

/// One journal. Nothing is created before the first append().
class ProgressJournal {
 public:
  explicit ProgressJournal(std::filesystem::path file) : file_(std::move(file)) {}
  ~ProgressJournal() { close(); }
  ProgressJournal(const ProgressJournal&) = delete;
  ProgressJournal& operator=(const ProgressJournal&) = delete;

  const std::filesystem::path& file() const { return file_; }
  /// What the file says; nothing if it is not there or has no record yet. Throws Error(bad_input)
  /// if it cannot be read, or if all of its records are damaged.
  JournalContents read() const;
  /// Keeps other programs from this journal until it is closed, if there is one; append() does so
  /// too. Throws Error(job_failed) if another program has it.
  void lock();
  /// Writes a record; it is on the disk afterwards. Throws Error(job_failed) if that fails.
  void append(const ProgressRecord& record);
  /// The job is done. Throws Error(job_failed) if the file cannot be removed.
  void remove();

 private:
  void open(int flags);
  void close();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace lamplock::job
