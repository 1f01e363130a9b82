// Runs of jobs on real boards, as their reports see them, and the command that continues a job.
#include "host/run/job_run.hpp"

#include <gmock/gmock.h>

#include <random>

#include "host/report/report.hpp"
#include "host/report/summary.hpp"
#include "host/run/continue_command.hpp"
#include "tests/scale.hpp"

namespace lamplock::run::job_run_test {
namespace {

using lamplock::test::scaled;

PreparedJob job_of(std::size_t count, std::uint8_t shots) {
  PreparedJob prepared{"p.xyz", {}, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    prepared.points.push_back({0.1 * static_cast<double>(i), 0, 0});
    wire::Target target;
    target.shots = shots;
    prepared.job.targets.push_back(target);
  }
  return prepared;
}

/// The board has reported some points, has fired on, and has marked where it restarted.
TEST(RunOnBoard, AfterARestartHasThePointsOfTheMark) {
  std::mt19937_64 random(1);
  for (int i = 0; i < scaled(200); ++i) {
    const std::size_t count = 2 + random() % 50, k = random() % count, from = random() % (k + 1);
    const std::size_t reported = from + random() % (k - from + 1);
    const auto shots = static_cast<std::uint8_t>(1 + random() % 3);
    const PreparedJob prepared = job_of(count, shots);
    BoardOptions options;
    options.from = from;
    options.command = {"lamplock", "send", "j.llj"};
    JobOutcome outcome;
    outcome.result.end = link::JobEnd::restarted;
    outcome.result.status.first_unfired = static_cast<std::uint32_t>(reported);
    outcome.result.status.shots = static_cast<std::uint32_t>((reported - from) * shots);
    outcome.result.status.beats = outcome.result.status.shots;
    outcome.result.rest = {k, 0, k, true};
    const report::Report report = report::evaluate(run_on_board(prepared, options, outcome));
    EXPECT_EQ(report.points_fired, k - from);
    EXPECT_EQ(report.shots, (k - from) * shots);
    EXPECT_LE(report.utilisation, 1);
    EXPECT_EQ(report.end.name, "restarted");
    EXPECT_EQ(report.end.first_unfired, k);
    EXPECT_EQ(report::headline(report),
              fmt::format("The machine restarted at {} of {}; continue with: lamplock send j.llj "
                          "--from {}",
                          k, count, k));
  }
}

TEST(RunOnBoard, OfADoneJobHasNoHeadline) {
  const PreparedJob prepared = job_of(5, 1);
  JobOutcome outcome;
  outcome.result.status.first_unfired = 5;
  outcome.result.status.shots = 5;
  outcome.result.rest = {5, 0, 5, true};
  const report::JobRun run = run_on_board(prepared, {}, outcome);
  EXPECT_FALSE(run.stopped_before);
  EXPECT_EQ(run.end.continue_with, "");
  EXPECT_EQ(report::headline(report::evaluate(run)), "");
}

TEST(ContinueCommand, ReplacesTheBegin) {
  const link::Continuation at_12{12, 0, 12, true}, in_flashes{12, 2, 12, true},
      unsettled{12, 0, 20, false};
  const std::vector<std::string> words{"lamplock", "engrave", "my model.stl", "--from=3",
                                       "--fired",  "1",       "--resume",     "--yes"};
  EXPECT_EQ(continue_command(words, at_12, true),
            "lamplock engrave 'my model.stl' --yes --from 12");
  EXPECT_EQ(continue_command(words, in_flashes, true),
            "lamplock engrave 'my model.stl' --yes --from 12 --fired 2");
  EXPECT_EQ(continue_command(words, unsettled, true),
            "lamplock engrave 'my model.stl' --yes --resume");
  EXPECT_EQ(continue_command(words, unsettled, false),
            "lamplock engrave 'my model.stl' --yes --from 20");
  EXPECT_EQ(continue_command({"l", "it's", "--from", "4", "--hold-at", "9"}, at_12, false),
            "l 'it'\\''s' --from 12");
  EXPECT_EQ(continue_command({}, at_12, false), "");
}

}  // namespace
}  // namespace lamplock::run::job_run_test
