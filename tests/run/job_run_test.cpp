// Runs of jobs on real boards, as their reports see them, and the command that continues a job.
#include "host/run/job_run.hpp"

#include <gmock/gmock.h>

#include <random>

#include "host/report/report.hpp"
#include "host/report/summary.hpp"
#include "host/run/continue_command.hpp"
#include "host/run/free_name.hpp"
#include "host/run/point_job_control.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

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

/// Readers see points; the argument of --from counts pauses too.
TEST(RunOnBoard, CountsPointsWithoutPauses) {
  PreparedJob prepared = job_of(9, 1);
  wire::Target pause;
  pause.shots = 0;
  pause.beats = 50;
  for (const int at : {8, 6, 4, 2})
    prepared.job.targets.insert(prepared.job.targets.begin() + at, pause);
  EXPECT_EQ(pauses_of(prepared.job), (std::vector<std::size_t>{2, 5, 8, 11}));
  BoardOptions options;
  options.from = 6;  // point 4, after two pauses
  options.command = {"lamplock", "send", "j.llj"};
  JobOutcome outcome;
  outcome.result.end = link::JobEnd::lost;
  outcome.result.rest = {9, 0, 12, true};  // points 6 to 7 are in doubt
  const report::JobRun run = run_on_board(prepared, options, outcome);
  const report::Report report = report::evaluate(run);
  EXPECT_EQ(report::headline(report),
            "Connection lost at 6 of 9 (points 6 to 7 may have been fired); continue with: "
            "lamplock send j.llj --from 12");
  EXPECT_EQ(report.from, 6u);
  EXPECT_EQ(report.points_before, 4u);
  EXPECT_EQ(report.points, 5u);
  EXPECT_EQ(report.pauses, 2u);
  EXPECT_EQ(report.pause_beats, 50u);
  EXPECT_EQ(run.stopped_before, 2u);
}

/// The board counts every beat of a dry run as one before the first shot.
TEST(RunOnBoard, ADryRunHasTheBeatsOfItsMotion) {
  PreparedJob prepared = job_of(5, 1);
  prepared.job.header.dry = true;
  JobOutcome outcome;
  wire::Status& status = outcome.result.status;
  const auto count = [&status](BeatReason reason, std::uint32_t beats) {
    status.beats_outside[static_cast<std::size_t>(reason)] = beats;
    status.beats_before += beats;
  };
  count(BeatReason::not_locked, 7);
  count(BeatReason::dry, 14);
  count(BeatReason::hold, 3);
  outcome.result.rest = {5, 0, 5, true};
  report::JobRun run = run_on_board(prepared, {}, outcome);
  const report::Report report = report::evaluate(run);
  EXPECT_TRUE(report.dry);
  EXPECT_EQ(report.beats, 17u);
  EXPECT_EQ(report.beats_before, 7u);
  EXPECT_EQ(run.beats_by_reason["dry"], 14u);
  EXPECT_EQ(run.beats_by_reason["hold"], 3u);
  EXPECT_EQ(run.beats_outside["not_locked"], 7u);
  EXPECT_DOUBLE_EQ(report.time_s, 17 / report.lamp_hz);
  EXPECT_DOUBLE_EQ(report.beats_per_point, 14 / 5.0);  // without the hold
  EXPECT_EQ(report.points_fired, 0u);
  EXPECT_EQ(report::headline(report), "Dry run: nothing was fired");
}

TEST(ContinueCommand, ReplacesTheBegin) {
  const link::Continuation at_12{12, 0, 12, true}, in_flashes{12, 2, 12, true},
      unsettled{12, 0, 20, false};
  const std::vector<std::string> words{"lamplock", "engrave", "my model.stl", "--from=3",
                                       "--fired",  "1",       "--resume",     "--yes"};
  EXPECT_EQ(continue_command(words, at_12, true), "lamplock engrave 'my model.stl' --from 12");
  EXPECT_EQ(continue_command(words, in_flashes, true),
            "lamplock engrave 'my model.stl' --from 12 --fired 2");
  EXPECT_EQ(continue_command(words, unsettled, true), "lamplock engrave 'my model.stl' --resume");
  EXPECT_EQ(continue_command(words, unsettled, false), "lamplock engrave 'my model.stl' --from 20");
  EXPECT_EQ(continue_command({"l", "it's", "--from", "4", "--hold-at", "9"}, at_12, false),
            "l 'it'\\''s' --from 12");
  EXPECT_EQ(continue_command({}, at_12, false), "");
}

/// The files of the first part remain: every output gets the next name that is free.
TEST(ContinueCommand, NamesNewOutputs) {
  const lamplock::test::TemporaryFolder folder;
  const link::Continuation at_12{12, 0, 12, true};
  const std::string report = folder.file("r.a").string(), shots = folder.file("s-9.csv").string();
  const auto advice = [&](const std::string& folder_name) {
    return continue_command({"l", "--report", folder_name, "--shots=" + shots, "--vcd"}, at_12,
                            false);
  };
  const std::string rest = " --shots=" + folder.file("s-10.csv").string() + " --vcd --from 12";
  EXPECT_EQ(advice(report), "l --report " + report + "-2" + rest);
  EXPECT_EQ(advice(report + "//"), "l --report " + report + "-2" + rest);
  folder.write("r.a-2", "");
  folder.write("r.a-3", "");
  EXPECT_EQ(advice(report), "l --report " + report + "-4" + rest);
  EXPECT_EQ(advice(report + "-2"), "l --report " + report + "-4" + rest);
  EXPECT_EQ(next_free_folder("."), "./report-2");
  EXPECT_EQ(next_free_folder("2026-11-27"), "2026-11-27-2");
  EXPECT_EQ(next_free_folder("at-1430"), "at-1430-2");
  EXPECT_EQ(next_free_name(".hidden"), ".hidden-2");
}

}  // namespace
}  // namespace lamplock::run::job_run_test
