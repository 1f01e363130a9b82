// The statistics file of jobs: lines of standard CSV.
#include "host/report/statistics.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "tests/error_of.hpp"
#include "tests/report/job_run.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::report::test {
namespace {

using lamplock::test::error_of;

/// Lines of fields, parsed as in RFC 4180.
std::vector<std::vector<std::string>> read_csv(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> line{""};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      line.back().push_back(text[++i]);
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      line.emplace_back();
    else if (!quoted && c == '\n')
      lines.push_back(std::exchange(line, {""}));
    else
      line.back().push_back(c);
  }
  return lines;
}

TEST(Statistics, WritesTheHeaderOnceAndALineForEachJob) {
  const lamplock::test::TemporaryFolder folder;
  const auto file = folder.file("jobs.csv");
  JobRun run = perfect_run(20, 1);
  run.input = "a \"fine\", long\nname.xyz";
  const auto when = std::chrono::system_clock::from_time_t(1'774'690'200);
  append_statistics(file, evaluate(run), "done", when);
  run.shots_known = false;
  append_statistics(file, evaluate(run), "stopped", when);
  const auto lines = read_csv(read_file(file));
  ASSERT_EQ(lines.size(), 3u);
  for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size());
  const auto value = [&lines](std::size_t line, const std::string& name) {
    for (std::size_t i = 0; i < lines[0].size(); ++i)
      if (lines[0][i] == name) return lines[line][i];
    return std::string("no such column");
  };
  EXPECT_EQ(value(1, "date"), "2026-03-28T09:30:00Z");
  EXPECT_EQ(value(1, "end"), "done");
  EXPECT_EQ(value(2, "end"), "stopped");
  EXPECT_EQ(value(1, "input"), run.input);
  EXPECT_EQ(value(1, "points"), "20");
  EXPECT_EQ(value(1, "points_fired"), "20");
  EXPECT_EQ(value(1, "beats"), "20");
  EXPECT_EQ(value(1, "missed"), "0");
  EXPECT_EQ(value(2, "missed"), "");  // unknown
}

const auto some_day = std::chrono::system_clock::from_time_t(1'774'690'200);

/// The header without the last `fewer` names.
std::string names_without(int fewer) {
  std::string names = statistics_names();
  names.pop_back();
  for (; fewer > 0; --fewer) names.erase(names.rfind(','));
  return names;
}

TEST(Statistics, LeavesForeignFilesUnchanged) {
  const lamplock::test::TemporaryFolder folder;
  const auto file = folder.file("jobs.csv");
  const std::string names = statistics_names();
  for (const std::string& other :
       {std::string("x,y,z\n1,2,3\n"), std::string("{\"points\": 3}"), std::string("\n") + names,
        std::string("date\n"), names_without(5) + "\n", "x" + names, std::string(200'000, 'a'),
        std::string("\0\1\2", 3)}) {
    write_file(file, other);
    EXPECT_THAT(error_of([&] { check_statistics(file); }), testing::HasSubstr("jobs.csv"));
    const Report report = evaluate(perfect_run(3, 1));
    error_of([&] { append_statistics(file, report, "done", some_day); });
    EXPECT_EQ(read_file(file), other);
  }
  check_statistics(folder.file("none.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("none.csv")));
}

TEST(Statistics, KeepsTheHeaderOfItsFile) {
  const lamplock::test::TemporaryFolder folder;
  const auto file = folder.file("jobs.csv");
  const Report report = evaluate(perfect_run(3, 1));
  // Of an older program, of a newer one, rewritten by another program, without the last newline.
  for (const std::string& begun : {names_without(1) + "\n", names_without(0) + ",new,newer\n",
                                   names_without(0) + "\r\n", names_without(0)}) {
    write_file(file, begun);
    append_statistics(file, report, "done", some_day);
    append_statistics(file, report, "stopped", some_day);
    const std::string text = read_file(file);
    EXPECT_TRUE(text.starts_with(begun));
    const auto lines = read_csv(text);
    ASSERT_EQ(lines.size(), 3u) << text;
    for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size()) << text;
    EXPECT_EQ(lines[2][1], "stopped");
  }
}

TEST(Statistics, OfAFileThatCannotBeWritten) {
  const Report report = evaluate(perfect_run(1, 1));
  const std::string error = error_of([&] {
    append_statistics("/proc/no/jobs.csv", report, "done", std::chrono::system_clock::now());
  });
  EXPECT_THAT(error, testing::HasSubstr("jobs.csv"));
}

}  // namespace
}  // namespace lamplock::report::test
