// The journal of a job: a file with which the job can continue after host or board have lost power.
//
// In:  the progress of the job, each time before more points are sent to the board.
// Out: the file; its information about the last run of the job.
// Who: link::KeptJob.
//
// A record is a line of text with a checksum, and is on the disk before append() returns. So an
// incomplete or damaged line at the end concerns points that have not been sent to the board: it
// is ignored.
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
#include <vector>

namespace lamplock::job {

struct Job;

/// State of a run in a record.
enum class Progress : std::uint8_t {
  begun,    ///< the job will be offered to the board; first_unfired and flashes: where it begins
  running,  ///< the record is a lower and an upper bound until the next one
  ended     ///< the board was at rest when it reported
};

struct ProgressRecord {
  Progress progress = Progress::begun;
  std::uint32_t session = 0;
  std::uint32_t job = 0;             ///< hash_of() the job
  std::uint32_t first_unfired = 0;   ///< all points, or lines, before it are fired
  std::uint32_t flashes = 0;         ///< of that point that are fired
  std::uint32_t may_have_fired = 0;  ///< no point from here on was sent to the board
  friend bool operator==(const ProgressRecord&, const ProgressRecord&) = default;
};

/// One run: its first and its last record.
struct KeptRun {
  ProgressRecord begun, last;
  friend bool operator==(const KeptRun&, const KeptRun&) = default;
};

/// Contents of a journal.
struct JournalContents {
  std::optional<KeptRun> run;           ///< the last run that the board has accepted
  std::vector<ProgressRecord> offered;  ///< later ones; the board may have accepted one of them
  bool empty() const { return !run && offered.empty(); }
  /// The offered run of this session; null if there is none.
  const ProgressRecord* find_offered(std::uint32_t session) const;
  friend bool operator==(const JournalContents&, const JournalContents&) = default;
};

/// Identifies a job: CRC-32 of the header and of all records.
std::uint32_t hash_of(const Job& job);

/// A record as its line, with the line end.
std::string progress_line(const ProgressRecord& record);

/// Parses the text of a journal.
JournalContents contents_of(std::string_view text);

/// One journal. Nothing is created before the first append().
class ProgressJournal {
 public:
  explicit ProgressJournal(std::filesystem::path file) : file_(std::move(file)) {}
  ~ProgressJournal() { close(); }
  ProgressJournal(const ProgressJournal&) = delete;
  ProgressJournal& operator=(const ProgressJournal&) = delete;

  const std::filesystem::path& file() const { return file_; }
  /// Reads the file; empty if it does not exist or has no record yet. Throws Error(bad_input) if it
  /// cannot be read, or if all of its records are damaged.
  JournalContents read() const;
  /// Locks this journal, if it exists, against other programs until it is closed; append() does so
  /// too. Throws Error(job_failed) if another program has locked it.
  void lock();
  /// Writes a record; it is on the disk afterwards. Throws Error(job_failed) if that fails.
  void append(const ProgressRecord& record);
  /// Removes the journal of a completed job. Throws Error(job_failed) if that fails.
  void remove();

 private:
  void open(int flags);
  void close();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace lamplock::job
