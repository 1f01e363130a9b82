// Report folders, and lines appended to files, when outputs fail.
#include "host/run/report_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <iterator>

#include "host/file/append_file.hpp"
#include "host/report/files.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::run::report_folder_test {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t count_entries(const fs::path& folder) {
  const fs::recursive_directory_iterator all(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

class ReportFolders : public testing::Test {
 protected:
  ReportFolders() {
    run_.points = {{0, 0, 0}, {1, 0, 0}};
    run_.shots_known = false;
    report_ = report::evaluate(run_);
  }
  lamplock::test::TemporaryFolder temporary_;
  report::JobRun run_;
  report::Report report_;
  LostFiles lost_;
};

TEST_F(ReportFolders, WithoutNumbersNothingIsLeft) {
  for (const char* const name : {"new", "new/in/new", "new/", "there"}) {
    fs::create_directory(temporary_.file("there"));
    const std::size_t before = count_entries(temporary_.file(""));
    { const ReportFolder folder(temporary_.file(name)); }
    check_report_folder(temporary_.file(name));
    EXPECT_EQ(count_entries(temporary_.file("")), before) << name;
  }
}

TEST_F(ReportFolders, FilesOfAnOlderReportGo) {
  ReportFolder folder(temporary_.file("r"));
  temporary_.write("r/shots.csv", "of an older job");
  temporary_.write("r/report.json", "older");
  folder.write_numbers(report_, lost_);
  EXPECT_EQ(contents(temporary_.file("r/report.json")), report::to_json(report_));
  EXPECT_TRUE(lost_.all().empty());
  EXPECT_EQ(count_entries(temporary_.file("r")), 1u);
}

TEST_F(ReportFolders, AFolderThatVanishesDuringTheJobIsMadeAgain) {
  ReportFolder folder(temporary_.file("a/r"));
  fs::remove_all(temporary_.file("a"));
  folder.write_numbers(report_, lost_);
  EXPECT_TRUE(lost_.all().empty());
  EXPECT_EQ(contents(temporary_.file("a/r/report.json")), report::to_json(report_));
}

TEST_F(ReportFolders, AFileThatFailsIsLostAlone) {
  ReportFolder folder(temporary_.file("r"));
  folder.write_numbers(report_, lost_);
  fs::create_directories(temporary_.file("r/report.html/in_the_way"));
  folder.write_rest(report_, run_, lost_);
  EXPECT_EQ(lost_.names(), (std::vector{temporary_.file("r/report.html").string()}));
  EXPECT_EQ(lost_.all().front().reason, "is a folder, not a file");
  EXPECT_TRUE(fs::exists(temporary_.file("r/cloud.png")));
  EXPECT_FALSE(fs::exists(temporary_.file("r/shots.csv")));  // the shots are unknown
}

/// The disk takes a part of the text only.
TEST_F(ReportFolders, ATextIsAppendedWholeOrNotAtAll) {
  const fs::path file = temporary_.write("jobs.csv", std::string(100, 'a'));
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  for (const rlim_t bytes : {100u, 101u, 150u, 199u, 200u}) {
    const rlimit limit{bytes, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string text(100, 'b');
    const auto append = [&] { append_whole(file, text); };
    if (bytes < 200)
      EXPECT_NE(lamplock::test::error_of(append), "") << bytes;
    else
      append();
    EXPECT_EQ(fs::file_size(file), bytes < 200 ? 100u : 200u);
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

}  // namespace
}  // namespace lamplock::run::report_folder_test
