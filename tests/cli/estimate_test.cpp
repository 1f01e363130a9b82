// `lamplock estimate` against `lamplock engrave`, its page, and the statistics file.
#include <gmock/gmock.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "host/cli/progress.hpp"
#include "host/job/profile.hpp"
#include "host/run/remaining_time.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

/// An estimate must equal the report of the run.
void expect_equal(const Json& estimated, const Json& run) {
  for (const char* key : {"points", "shots", "beats", "beats_before", "beats_per_point",
                          "utilisation", "beats_by_reason", "settings", "mode", "lamp_hz"})
    EXPECT_EQ(estimated[key], run[key]) << key;
  EXPECT_NEAR(estimated["time_s"].get<double>(), run["time_s"].get<double>(), 1e-6);
}

TEST(EstimateCommand, equals_the_report_of_the_run) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(700, 3)));
  const std::string machine = folder.write("m.toml", "lamp_energy = 1\n");
  const std::vector<std::vector<std::string>> options{
      {},
      {"--lamp", "200", "--accel", "2"},
      {"--flashes", "3", "--mode", "start-stop"},
      {"--lamp-mode", "master", "--machine", machine, "--job-speed", "60"},
      {"--from", "300"},
      {"--flashes", "3", "--from", "300", "--fired", "2"},
      {"--origin", "zero"}};
  for (const auto& more : options) {
    std::vector<std::string> arguments{"estimate", points, "--order", "given"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Json estimated = run_json(arguments);
    arguments[0] = "engrave";
    expect_equal(estimated, run_json(arguments));
  }
}

TEST(EstimateCommand, of_a_job_file) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(200, 4)));
  const std::string job = folder / "p.llj";
  ASSERT_EQ(run({"job", points, "-o", job}).status, 0);
  expect_equal(run_json({"estimate", job}), run_json({"send", job}));
}

TEST(EstimateCommand, prints_text_and_writes_a_page) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(50, 5)));
  const Finished estimated = run({"estimate", points, "--page", folder / "p.html"});
  EXPECT_EQ(estimated.status, 0) << estimated.err;
  for (const char* word :
       {"points", "utilisation", "machine time", "if the job starts now, it ends on"})
    EXPECT_THAT(estimated.out, HasSubstr(word));
  EXPECT_THAT(estimated.out, Not(HasSubstr("missed")));
  EXPECT_THAT(read(folder / "p.html"), testing::StartsWith("<!doctype html>"));
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"p.html", "p.xyz"}));
}

TEST(EstimateCommand, refuses_in_one_line) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(5, 6)));
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"estimate", folder / "none.xyz"},
                                             {"estimate", points, "--from", "5"},
                                             {"estimate", points, "--page", folder / "no/p.html"},
                                             {"estimate", points, "--job-speed", "0"},
                                             {"estimate"}}) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 2) << arguments.back();
    EXPECT_EQ(lines(finished.err).size(), 1u) << finished.err;
  }
}

TEST(EstimateCommand, takes_an_origin_as_engrave_does) {
  // A work space away from the origin: objects lie in its middle, or around the origin.
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::string profile = folder.write("m.toml", "min_corner = [-3, -3, -10]\n");
  const std::vector<std::string> how{mesh,  "--size",    "4",     "--spacing",
                                     "0.4", "--machine", profile, "--origin"};
  for (const char* origin : {"machine", "zero"}) {
    const auto with = [&](const char* command) {
      std::vector<std::string> arguments{command};
      arguments.insert(arguments.end(), how.begin(), how.end());
      arguments.emplace_back(origin);
      return run_json(arguments);
    };
    expect_equal(with("estimate"), with("engrave"));
  }
}

TEST(EstimateCommand, of_a_job_file_refuses_options_that_make_one) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(20, 4)));
  const std::string job = folder / "p.llj";
  ASSERT_EQ(run({"job", points, "-o", job}).status, 0);
  for (const auto& option : std::vector<std::vector<std::string>>{{"--size", "3"},
                                                                  {"--order", "best"},
                                                                  {"--lamp", "50"},
                                                                  {"--flashes", "2"},
                                                                  {"--no-end-points"},
                                                                  {"--origin", "zero"}}) {
    for (std::vector<std::string> arguments :
         std::vector<std::vector<std::string>>{{"estimate", job}, {"job", "--show", job}}) {
      if (arguments[0] == "job" && option[0] == "--origin") continue;  // it has no such option
      arguments.insert(arguments.end(), option.begin(), option.end());
      const Finished refused = run(arguments);
      EXPECT_EQ(refused.status, 2) << option[0];
      EXPECT_EQ(lines(refused.err).size(), 1u) << refused.err;
      EXPECT_THAT(refused.err,
                  HasSubstr(option[0] == "--no-end-points" ? "end-points" : option[0]));
      EXPECT_EQ(refused.out, "");
    }
  }
  for (const auto& option : std::vector<std::vector<std::string>>{
           {"-o", folder / "q.llj"}, {"--save", folder / "q.toml"}, {"--dry"}}) {
    std::vector<std::string> arguments{"job", "--show", job};
    arguments.insert(arguments.end(), option.begin(), option.end());
    EXPECT_EQ(run(arguments).status, 2) << option[0];
  }
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"p.llj", "p.xyz"}));
}

TEST(Statistics, a_line_for_every_job) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(40, 7)));
  const std::string file = folder / "jobs.csv";
  for (int i = 0; i < 2; ++i) ASSERT_EQ(run({"engrave", points, "--statistics", file}).status, 0);
  const auto rows = lines(read(file));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_THAT(rows[0], testing::StartsWith("date,end,input,"));
  for (const int i : {1, 2}) EXPECT_THAT(rows[static_cast<std::size_t>(i)], HasSubstr(",done,"));
}

TEST(Statistics, keeps_foreign_files) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(40, 7)));
  const std::string notes = folder.write("notes.csv", "when,what\n");
  for (const std::string& file : {notes, points}) {
    const std::string before = read(file);
    const Finished refused =
        run({"engrave", points, "--statistics", file, "--report", folder / "r"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr(file));
    EXPECT_EQ(read(file), before);
  }
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"notes.csv", "p.xyz"}));
}

TEST(Statistics, an_unwritable_file_is_reported_before_the_job) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(40, 7)));
  const Finished finished =
      run({"engrave", points, "--statistics", folder / "no/jobs.csv", "--report", folder / "r"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_EQ(folder.files(), std::vector<std::string>{"p.xyz"});
}

TEST(RemainingTime, is_of_the_machine_that_runs_the_job) {
  job::Profile at_home = job::default_profile();
  const job::Job job = job::make_job(walk(300, 9), at_home, {});
  // The machine reports that it is slower; the local profile does not mention that.
  link::BoardSettings machine;
  for (const std::string& line : {std::string("$120=500.000"), std::string("$121=500.000"),
                                  std::string("$122=500.000"), std::string("$901=40.000")})
    ASSERT_TRUE(link::take_setting(line, machine)) << line;
  job::Job on_machine = job;
  on_machine.settings = run::settings_in_job(job, machine);
  EXPECT_EQ(on_machine.settings.milli(settings::Id::acceleration_x), 500'000);
  EXPECT_EQ(on_machine.settings.milli(settings::Id::max_rate_x),
            job.settings.milli(settings::Id::max_rate_x));
  const double slow_s = *run::RemainingTime(on_machine, 0, 100).left_s(0, 100);
  job::set_acceleration(at_home, 0.5);
  job::set_lamp_hz(at_home, 40);
  const job::Job stated = job::make_job(walk(300, 9), at_home, {});
  EXPECT_NEAR(slow_s, *run::RemainingTime(stated, 0, 100).left_s(0, 100), 1e-9);
  EXPECT_GT(slow_s, 1.5 * *run::RemainingTime(job, 0, 100).left_s(0, 100));
  // Settings stated by the job apply on any machine.
  EXPECT_EQ(run::settings_in_job(stated, machine).milli(settings::Id::lamp_frequency), 40'000);
  machine.values.set_milli(settings::Id::lamp_frequency, 200'000);
  EXPECT_EQ(run::settings_in_job(stated, machine).milli(settings::Id::lamp_frequency), 40'000);
}

TEST(ProgressText, reports_the_end_of_long_jobs) {
  ::setenv("TZ", "UTC", 1);
  ::tzset();
  constexpr std::time_t now = 1'774'690'200;  // 2026-03-28 09:30
  EXPECT_EQ(left_text(12, now), ", 12 s left");
  EXPECT_EQ(left_text(600, now), ", 10 min 00 s left, ends 09:40");
  EXPECT_EQ(left_text(86400, now), ", 24 h 00 min 00 s left, ends 2026-03-29 09:30");
  EXPECT_EQ(left_text(-1, now), ", 0 s left");
  EXPECT_EQ(left_text(1e300, now), ", years left");
}

}  // namespace
}  // namespace lamplock::cli::test
