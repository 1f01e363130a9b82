// The journal of a job: its contents after a power loss at every byte, torn and damaged lines.
#include "host/job/progress_journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/job/job.hpp"
#include "tests/job/random_rows.hpp"
#include "tests/link/random_job.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::job::progress_journal_test {
namespace {

constexpr std::uint32_t job_hash = 0x9f3c11aa;

/// Two runs; the second one continues where the first one ended.
const std::vector<ProgressRecord> two_runs{
    {Progress::begun, 0x5eed, job_hash, 0, 0, 0},
    {Progress::running, 0x5eed, job_hash, 0, 0, 1024},
    {Progress::running, 0x5eed, job_hash, 503, 0, 1527},
    {Progress::ended, 0x5eed, job_hash, 687, 2, 687},
    {Progress::begun, 0xfeedbeef, job_hash, 687, 2, 687},
    {Progress::running, 0xfeedbeef, job_hash, 700, 0, 4'000'000'000},
};

std::string text_of(const std::vector<ProgressRecord>& records) {
  std::string text = "# heading\n";
  for (const ProgressRecord& record : records) text += progress_line(record);
  return text;
}

/// Expected contents after this many records.
JournalContents contents_after(std::size_t records) {
  if (records == 0) return {};
  if (records == 1) return {std::nullopt, {two_runs[0]}};
  if (records == 5) return {KeptRun{two_runs[0], two_runs[3]}, {two_runs[4]}};
  return {KeptRun{two_runs[records > 5 ? 4 : 0], two_runs[records - 1]}, {}};
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(ProgressJournal, PowerLossAtEveryByteLosesOnlyTheUnfinishedRecord) {
  const std::string text = text_of(two_runs);
  for (std::size_t size = 0; size <= text.size(); ++size) {
    const std::string kept = text.substr(0, size);
    const std::size_t lines = lines_in(kept);
    EXPECT_EQ(contents_of(kept), contents_after(lines == 0 ? 0 : lines - 1)) << size;
  }
}

/// A job that the board has refused keeps the record of the preceding run.
TEST(ProgressJournal, ARunThatWasOnlyOfferedDoesNotReplaceThePrecedingOne) {
  const ProgressRecord refused{Progress::begun, 7, job_hash, 5, 0, 5};
  const std::string text = text_of({two_runs[0], two_runs[2], refused});
  EXPECT_EQ(contents_of(text), (JournalContents{KeptRun{two_runs[0], two_runs[2]}, {refused}}));
  EXPECT_EQ(contents_of(text + progress_line(two_runs[3])),
            (JournalContents{KeptRun{two_runs[0], two_runs[3]}, {}}));
}

/// The board may have accepted the first offer, whose answer was lost, and refused the second one.
TEST(ProgressJournal, KeepsAllOffersUntilOneIsAccepted) {
  const ProgressRecord first{Progress::begun, 7, job_hash, 0, 0, 0};
  const ProgressRecord second{Progress::begun, 8, job_hash, 0, 0, 0};
  const ProgressRecord running{Progress::running, 7, job_hash, 3, 0, 9};
  const std::string text = text_of({first, second});
  EXPECT_EQ(contents_of(text), (JournalContents{{}, {first, second}}));
  EXPECT_EQ(contents_of(text + progress_line(running)),
            (JournalContents{KeptRun{first, running}, {}}));
}

TEST(ProgressJournal, ContinuesAfterATornLine) {
  const test::TemporaryFolder folder;
  const std::string text = text_of(two_runs);
  const ProgressRecord next{Progress::begun, 7, job_hash, 5, 0, 5};
  for (std::size_t size = 0; size <= text.size(); size += 5) {
    const auto file = folder.write("a.llj.progress", text.substr(0, size));
    ProgressJournal(file).append(next);
    EXPECT_EQ(ProgressJournal(file).read().offered.back(), next) << size;
  }
}

TEST(ProgressJournal, AnyDamagedCharacterVoidsItsLine) {
  const std::string text = progress_line(two_runs[3]);
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    for (const char other : {'0', '7', 'f', ' ', 'x', '\0'}) {
      std::string damaged = text;
      if (damaged[i] == other) continue;
      damaged[i] = other;
      EXPECT_TRUE(contents_of(damaged).empty()) << damaged;
    }
}

TEST(ProgressJournal, WithoutAGoodRecordItIsDamaged) {
  const test::TemporaryFolder folder;
  std::string other_ends = text_of(two_runs);
  for (std::size_t at = 0; (at = other_ends.find('\n', at)) != std::string::npos; at += 2)
    other_ends.replace(at, 1, "\r\n");
  for (const std::string& damaged : {other_ends, std::string("begun\n"), std::string("x\ny\n")}) {
    const ProgressJournal journal(folder.write("a.progress", damaged));
    EXPECT_THROW(journal.read(), Error) << damaged;
  }
  // The first record was torn, or was not written.
  for (const std::string begun : {"# kind", "# kind\n", "# kind\nbegun 5e"})
    EXPECT_TRUE(ProgressJournal(folder.write("a.progress", begun)).read().empty()) << begun;
}

TEST(ProgressJournal, BelongsToOneProgram) {
  const test::TemporaryFolder folder;
  const auto file = folder.file("a.progress");
  ProgressJournal other(file);
  other.lock();
  EXPECT_FALSE(std::filesystem::exists(file));
  {
    ProgressJournal journal(file);
    journal.append(two_runs[0]);
    EXPECT_THROW(other.lock(), Error);
    EXPECT_THROW(other.append(two_runs[1]), Error);
  }
  other.append(two_runs[1]);
  EXPECT_EQ(other.read(), contents_after(2));
}

TEST(ProgressJournal, IsWrittenReadAndRemoved) {
  const test::TemporaryFolder folder;
  const auto file = folder.file("a.llj.progress");
  EXPECT_TRUE(ProgressJournal(file).read().empty());
  EXPECT_FALSE(std::filesystem::exists(file)) << "reading must not create a file";
  ProgressJournal journal(file);
  for (std::size_t i = 0; i < two_runs.size(); ++i) {
    journal.append(two_runs[i]);
    EXPECT_EQ(ProgressJournal(file).read(), contents_after(i + 1));
  }
  EXPECT_THAT(read_file(file), testing::StartsWith("# "));
  journal.remove();
  EXPECT_FALSE(std::filesystem::exists(file));
  journal.append(two_runs[0]);
  EXPECT_EQ(journal.read(), contents_after(1));
}

TEST(ProgressJournal, AWriteErrorIsReportedInOneLine) {
  const test::TemporaryFolder folder;
  try {
    ProgressJournal(folder.file("none/a.progress")).append(two_runs[0]);
    FAIL() << "written into a missing folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    EXPECT_THAT(error.what(),
                testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+--progress[^\n]+"));
  }
}

TEST(ProgressJournal, AFileThatIsRemovedDuringTheJobIsReported) {
  const test::TemporaryFolder folder;
  ProgressJournal journal(folder.file("a.progress"));
  journal.append(two_runs[0]);
  std::filesystem::remove(folder.file("a.progress"));
  EXPECT_THAT([&] { journal.append(two_runs[1]); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("was removed during the job")));
}

TEST(JobHash, DistinguishesJobs) {
  const Job points = test::random_job(300, 1);
  EXPECT_EQ(hash_of(points), hash_of(test::random_job(300, 1)));
  EXPECT_NE(hash_of(points), hash_of(test::random_job(300, 2)));
  Job other = points;
  ++other.targets[299].steps[1];
  EXPECT_NE(hash_of(points), hash_of(other));
  other = points;
  other.header.points_total += 1;
  EXPECT_NE(hash_of(points), hash_of(other));
  EXPECT_NE(hash_of(test::random_row_job(50, 1)), hash_of(test::random_row_job(50, 2)));
}

}  // namespace
}  // namespace lamplock::job::progress_journal_test
