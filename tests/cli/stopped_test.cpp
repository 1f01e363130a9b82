// Jobs that end early: fired points are reported with the numbers for continuing.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

/// Points a step apart, then a point so far that the slow machine is refused the move to it; the
/// refusal comes after the machine has begun to move.
struct Refused {
  static constexpr int near = 100;
  Refused() {
    std::string points;
    for (int i = 0; i < near; ++i) points += fmt::format("{} 0 0\n", 0.005 * (i % 2));
    list = folder.write("p.xyz", points + "40 0 0\n");
  }
  Finished engrave(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"engrave", list, "--speed", "0.0002", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  /// The number after --from in the error message.
  static int continue_at(const Finished& refused) {
    const auto at = refused.err.find("--from ");
    EXPECT_NE(at, std::string::npos) << refused.err;
    return at == std::string::npos ? -1 : std::stoi(refused.err.substr(at + 7));
  }
  Folder folder;
  std::string list;
};

TEST(StoppedJobs, ARefusalInMidJobIsReported) {
  const Refused job;
  const Finished refused = job.engrave({"--report", job.folder / "report", "--statistics",
                                        job.folder / "jobs.csv", "--shots", job.folder / "s.csv"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("error: point 100: cannot be reached"));
  const int fired = Refused::continue_at(refused);
  EXPECT_GT(fired, 0);
  EXPECT_LT(fired, Refused::near);
  const Json report = Json::parse(refused.out, nullptr, false);
  EXPECT_EQ(report["end"], "failed");
  EXPECT_EQ(report["points"], Refused::near + 1);
  EXPECT_EQ(report["points_fired"], fired);
  EXPECT_EQ(report["shots"], fired);
  EXPECT_EQ(report["first_unfired"], fired);
  EXPECT_EQ(report["missed"], Refused::near + 1 - fired);
  EXPECT_DOUBLE_EQ(report["beats_per_point"], report["beats"].get<double>() / fired);
  EXPECT_EQ(Json::parse(read(job.folder / "report/report.json"))["points_fired"], fired);
  EXPECT_EQ(read_shots(job.folder / "report/shots.csv").size(), static_cast<std::size_t>(fired));
  EXPECT_EQ(read_shots(job.folder / "s.csv").size(), static_cast<std::size_t>(fired));
  const auto jobs = lines(read(job.folder / "jobs.csv"));
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_THAT(jobs[0], testing::EndsWith(",points_fired"));
  EXPECT_THAT(jobs[1], HasSubstr(",failed,"));
  EXPECT_THAT(jobs[1], testing::EndsWith(fmt::format(",{}", fired)));
}

TEST(StoppedJobs, TextKeysAndPageAgreeOnTheEnd) {
  const Refused job;
  const Finished refused = job.engrave({"--report", job.folder / "report"});
  const int fired = Refused::continue_at(refused);
  const Json report = Json::parse(read(job.folder / "report/report.json"));
  EXPECT_EQ(report["end"], "failed");
  EXPECT_EQ(report["first_unfired"], fired);
  EXPECT_EQ(report["may_have_fired"], fired);
  const std::string command = report["continue_with"];
  EXPECT_THAT(command, testing::EndsWith(fmt::format(" --from {}", fired)));
  EXPECT_THAT(command, HasSubstr(" engrave " + job.list));
  const std::string headline =
      fmt::format("Failed at {} of {}; continue with: {}", fired, Refused::near + 1, command);
  EXPECT_THAT(refused.err, HasSubstr("\n" + headline + "\n"));  // stdout has the document
  const std::string page = read(job.folder / "report/report.html");
  EXPECT_THAT(page, HasSubstr(Json(headline).dump()));
  EXPECT_THAT(page, HasSubstr(fmt::format("\"not_reached\":{},", Refused::near + 1 - fired)));
}

TEST(StoppedJobs, ADryRunReportsItsMotionAndNoShot) {
  const Folder folder;
  const std::string list = folder.write("s.xyz", "0 0 0\n1 0 0\n1 1 0\n0 1 1\n");
  const Finished done = run({"engrave", list, "--yes", "--dry", "--report", folder / "dry"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("Dry run: nothing was fired\n"));
  const Json report = Json::parse(read(folder / "dry/report.json"));
  EXPECT_EQ(report["dry"], true);
  EXPECT_EQ(report["first_unfired"], nullptr);
  EXPECT_EQ(report["points_fired"], 0);
  EXPECT_GE(report["beats"], 4);
  EXPECT_EQ(report["beats"], report["beats_by_reason"]["dry"]);
  EXPECT_GT(report["time_s"], 0);
  ASSERT_EQ(run({"engrave", list, "--report", folder / "fired"}).status, 0);
  const Finished compared = run({"compare", folder / "dry", folder / "fired"});
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, testing::ContainsRegex("dry run +yes +no\n"));
}

TEST(StoppedJobs, TheAdviceKeepsTheReportOfTheFirstPart) {
  const Refused job;
  const std::string report = job.folder / "report";
  const int fired = Refused::continue_at(job.engrave({"--yes", "--report", report}));
  const std::string first_part = read(report + "/report.json");
  EXPECT_THAT(Json::parse(first_part)["continue_with"].get<std::string>(),
              testing::EndsWith(fmt::format(" --json --report {}-2 --from {}", report, fired)));
  const std::string from = std::to_string(fired);
  const Finished refused = job.engrave({"--from", from, "--report", report});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("give a new folder: --report " + report + "-2\n"));
  EXPECT_EQ(read(report + "/report.json"), first_part);
  // From its beginning the job may replace the report, as every job may.
  EXPECT_EQ(job.engrave({"--report", report}).status, 1);
}

TEST(StoppedJobs, ARefusalBeforeTheFirstShotLeavesNothing) {
  const Refused job;
  const auto before = job.folder.files();
  const std::string last = std::to_string(Refused::near);
  const Finished refused = job.engrave(
      {"--from", last, "--report", job.folder / "report", "--statistics", job.folder / "jobs.csv"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(job.folder.files(), before);
}

TEST(StoppedJobs, NumbersCountPausesEverywhere) {
  const Refused job;
  const Finished refused =
      job.engrave({"--pause-every", "5", "--pause-beats", "3", "--report", job.folder / "report"});
  EXPECT_EQ(refused.status, 1);
  const int next = Refused::continue_at(refused);
  const Json report = Json::parse(refused.out, nullptr, false);
  const int fired = report["points_fired"];
  EXPECT_EQ(report["first_unfired"], next);
  // Five points, a pause, five points, a pause...
  EXPECT_EQ(next, fired + fired / 5 - (fired % 5 == 0 && next % 6 == 5 ? 1 : 0));
  const auto shots = lines(read(job.folder / "report/shots.csv"));
  ASSERT_EQ(shots.size(), static_cast<std::size_t>(fired) + 1);
  EXPECT_THAT(shots[0], testing::EndsWith(",point"));
  for (int i = 0; i < fired; ++i)
    EXPECT_THAT(shots[static_cast<std::size_t>(i) + 1],
                testing::EndsWith(fmt::format(",{}", i + i / 5)));
  const std::string headline = fmt::format("Failed at {} of {};", fired, Refused::near + 1);
  EXPECT_THAT(refused.err, HasSubstr(headline));
  EXPECT_THAT(read(job.folder / "report/report.html"), HasSubstr(headline));
  EXPECT_EQ(report["beats_by_reason"]["pause"], 3 * ((fired - 1) / 5));
  // The rest of the job begins with that number, on its page too.
  const Finished rest = run({"engrave", job.list, "--pause-every", "5", "--pause-beats", "3",
                             "--from", std::to_string(next), "--report", job.folder / "rest"});
  ASSERT_EQ(rest.status, 0) << rest.err;
  EXPECT_EQ(lines(read(job.folder / "rest/shots.csv")).size(),
            static_cast<std::size_t>(Refused::near + 1 - fired) + 1);
  EXPECT_THAT(read(job.folder / "rest/report.html"), HasSubstr(fmt::format("\"first\":{},", next)));
  const Json of_rest = Json::parse(read(job.folder / "rest/report.json"));
  EXPECT_EQ(of_rest["from"], next);
  EXPECT_EQ(of_rest["points_before"], fired);
  EXPECT_EQ(of_rest["size_mm"], report["size_mm"]);
  EXPECT_THAT(read(job.folder / "rest/job.toml"),
              testing::StartsWith(
                  fmt::format("# This report is about the rest of a job: --from {}.", next)));
}

TEST(StoppedJobs, ALampThatTheClockCannotFollow) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 3)));
  const std::string machine = folder.write("m.toml", "lamp_energy = 1\n");
  for (const auto& fault : std::vector<std::vector<std::string>>{
           {"--wander", "50"},
           {"--dropouts", "100"},
           {"--dropouts", "100", "--lamp", "20"},
           {"--dropouts", "100", "--lamp-mode", "master", "--machine", machine}}) {
    std::vector<std::string> arguments{"engrave", list, "--statistics", folder / "jobs.csv"};
    arguments.insert(arguments.end(), fault.begin(), fault.end());
    const Finished refused = run(arguments);
    EXPECT_EQ(refused.status, 2) << fault[0];
    EXPECT_THAT(refused.err, HasSubstr("error: simulated lamp: "));
    EXPECT_THAT(refused.err, HasSubstr("--wander"));
  }
  // The program waits for a lamp that is lost now and then, for long pauses and for long moves.
  const std::string far = folder.write("far.xyz", "0 0 0\n1.4 0 0\n");
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"engrave", list, "--wander", "12"},
           {"engrave", list, "--pause-every", "10", "--pause-beats", "15000"},
           {"engrave", far, "--speed", "0.00002"},
           {"engrave", far, "--speed", "0.00002", "--dry"}}) {
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 0) << done.err;
  }
}

}  // namespace
}  // namespace lamplock::cli::test
