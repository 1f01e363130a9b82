#include "host/report/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/report/job_run.hpp"

namespace lamplock::report {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

Report example(const char* mode, std::uint64_t beats) {
  JobRun run = test::perfect_run(2000, 1);
  run.mode = mode;
  run.beats = beats;
  run.time_s = static_cast<double>(beats) / 100;
  run.beats_by_reason = {{"travel", beats - 2000}, {"dropout", 0}};
  run.link.resent = 4;
  return evaluate(run);
}

TEST(Summary, OneReport) {
  const std::string text = summary(example("free", 12'345));
  EXPECT_THAT(text, ContainsRegex("cloud.xyz: free, virtual board, lamp 100 Hz"));
  EXPECT_THAT(text, ContainsRegex("points +2 000\n"));
  EXPECT_THAT(text, ContainsRegex("points fired +2 000\n"));
  EXPECT_THAT(text, ContainsRegex("beats +12 345\n"));
  EXPECT_THAT(text, ContainsRegex("utilisation +16\\.2 %\n"));
  EXPECT_THAT(text, ContainsRegex("machine time +2 min 03 s\n"));
  EXPECT_THAT(text, ContainsRegex("missed points +0\n"));
  EXPECT_THAT(text, ContainsRegex("beats: travel +10 345\n"));
  EXPECT_THAT(text, ContainsRegex("frames resent +4\n"));
  EXPECT_THAT(text, Not(HasSubstr("dropout")));
}

TEST(Summary, TwoReportsSideBySideWithTheirRatio) {
  const std::string text = summary(example("start-stop", 4000), example("free", 3000));
  EXPECT_THAT(text, ContainsRegex("start-stop +free\n"));
  EXPECT_THAT(text, ContainsRegex("beats +4 000 +3 000\n"));
  EXPECT_THAT(text, ContainsRegex("beats per point +2\\.000 +1\\.500\n"));
  EXPECT_THAT(text, ContainsRegex("machine time +40\\.00 s +30\\.00 s\n"));
  EXPECT_THAT(text, ContainsRegex("ratio +0\\.750\n"));
}

TEST(Summary, ARowOfTimesHasOneForm) {
  EXPECT_THAT(summary(example("free", 4000), example("free", 12'345)),
              ContainsRegex("machine time +0 min 40 s +2 min 03 s\n"));
  EXPECT_THAT(summary(example("free", 12'345), example("free", 400'000)),
              ContainsRegex("machine time +0 h 02 min 03 s +1 h 06 min 40 s\n"));
}

TEST(Summary, TwoReportsShowHowTheyWereRun) {
  Report first = example("free", 4000), second = first;
  EXPECT_THAT(summary(first, second), Not(ContainsRegex("end|from|flashes|pauses|dry")));
  first.end = {"stopped", 12, 12, "lamplock"};
  second.end = {"done", 2000, 2000, ""};
  second.from = 12;
  second.flashes_per_point = 3;
  second.pauses = 4;
  second.pause_beats = 500;
  const std::string text = summary(first, second);
  EXPECT_THAT(text, ContainsRegex("end +stopped +done\n"));
  EXPECT_THAT(text, ContainsRegex("from +0 +12\n"));
  EXPECT_THAT(text, ContainsRegex("flashes per point +1 +3\n"));
  EXPECT_THAT(text, ContainsRegex("pauses +0 +4 of 500 beats\n"));
}

TEST(Summary, TwoReportsShowWhatDiffers) {
  Report first = example("free", 4000), second = example("free", 3000);
  second.settings.set_milli(settings::Id::lamp_frequency, 120'500);
  first.making.method = "slice";
  second.making.method = "faces";
  first.making.spacing_mm = second.making.spacing_mm = 0.25;
  const std::string text = summary(first, second, {"stop", "a/free"});
  EXPECT_EQ(text.find("stop"), text.find_first_not_of(' ')) << "the first line has the headings";
  EXPECT_THAT(text, ContainsRegex("stop +a/free\n"));
  EXPECT_THAT(text, ContainsRegex("lamp_frequency +100 Hz +120\\.5 Hz\n"));
  EXPECT_THAT(text, ContainsRegex("method +slice +faces\n"));
  EXPECT_THAT(text, Not(HasSubstr("spacing")));
  EXPECT_THAT(text, Not(HasSubstr("acceleration")));
  EXPECT_EQ(differing_settings(first, second), std::vector{settings::Id::lamp_frequency});
}

TEST(Summary, ColumnsAreAligned) {
  std::istringstream lines(summary(example("start-stop", 400'000), example("free", 3000)));
  std::size_t width = 0;
  for (std::string line; std::getline(lines, line);) {
    if (width == 0) width = line.size();
    EXPECT_EQ(line.size(), width) << line;
  }
}

TEST(Summary, UnknownValuesAreMarked) {
  JobRun run = test::job(10, 1);
  run.shots_known = false;
  EXPECT_THAT(summary(evaluate(run)), ContainsRegex("missed points +unknown\n"));
}

TEST(EstimateSummary, HasOnlyPredictableValues) {
  const std::string text = estimate_summary(evaluate(test::perfect_run(1234, 1)));
  for (const char* label : {"points", "beats", "utilisation", "machine time", "before the first"})
    EXPECT_NE(text.find(label), std::string::npos) << label;
  for (const char* label : {"missed", "doubled", "error", "jitter", "link", "unknown"})
    EXPECT_EQ(text.find(label), std::string::npos) << label;
}

TEST(Summary, BeginsWithTheEndOfAJobThatEndedEarly) {
  Report report = example("free", 6773);
  report.points = 6773;
  const auto headline_of = [&report](const char* end, std::uint64_t first, std::uint64_t from) {
    report.end = {end, first, from, first < report.points ? "lamplock send j.llj --from 1" : ""};
    const std::string text = summary(report), head = headline(report);
    EXPECT_TRUE(text.starts_with(head.empty() ? report.input : head + "\n")) << text;
    return head;
  };
  EXPECT_EQ(headline_of("stopped", 2123, 2123),
            "Stopped at 2 123 of 6 773; continue with: lamplock send j.llj --from 1");
  EXPECT_EQ(
      headline_of("lost", 503, 687),
      "Connection lost at 503 of 6 773 (points 503 to 686 may have been fired); continue with: "
      "lamplock send j.llj --from 1");
  EXPECT_EQ(headline_of("restarted", 3, 4),
            "The machine restarted at 3 of 6 773 (point 3 may have been fired); continue with: "
            "lamplock send j.llj --from 1");
  EXPECT_EQ(headline_of("failed", 6773, 6773), "Failed at 6 773 of 6 773");
  EXPECT_EQ(headline_of("done", 6773, 6773), "");
  EXPECT_EQ(headline_of("", 0, 0), "");
  report.dry = true;
  EXPECT_EQ(headline_of("done", 6773, 6773), "Dry run: nothing was fired");
  EXPECT_EQ(headline_of("lost", 503, 687),
            "Dry run: nothing was fired. Connection lost at 503 of 6 773; continue with: lamplock "
            "send j.llj --from 1");
  EXPECT_THAT(summary(report, example("free", 6773)), ContainsRegex("dry run +yes +no\n"));
}

}  // namespace
}  // namespace lamplock::report
