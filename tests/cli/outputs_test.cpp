// Outputs that cannot be written: before the first shot nothing is done, after it the exit status
// never says so.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"
#include "tests/drawings.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test::outputs {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;
using OptionsAndFiles = std::vector<std::pair<std::string, std::string>>;
using testing::HasSubstr;
using testing::Not;

/// Files that programs started meanwhile can write grow to this size only, as on a full disk.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  rlimit before_{};
};

class Outputs : public testing::Test {
 protected:
  Outputs() {
    list_ = folder_.write("p.xyz", xyz(walk(60, 1)));
    fs::create_symlink("/dev/full", folder_ / "full.svg");
  }
  /// Options and files in a folder.
  static OptionsAndFiles files_in(const std::string& folder) {
    return {{"--report", folder + "/new/report"},
            {"--statistics", folder + "/jobs.csv"},
            {"--vcd", folder + "/v.vcd"},
            {"--shots", folder + "/s.csv"},
            {"--plot", folder + "/m.svg"}};
  }
  Finished engrave(const Arguments& more) const {
    Arguments all{"engrave", list_};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }

  Folder folder_;
  std::string list_;
};

TEST_F(Outputs, AreProvedWritableBeforeTheFirstShot) {
  const auto before = folder_.files();
  for (const auto& [option, file] : files_in("/proc")) {
    const Finished refused = engrave({option, file});
    EXPECT_EQ(refused.status, 2) << option;
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: /proc/[^\n]+; [^\n]+\n"));
    EXPECT_EQ(refused.out, "") << "work was done before the refusal of " << option;
  }
  for (const auto& [option, file] : files_in(folder_.path())) {
    const SizeLimit full(0);
    EXPECT_EQ(engrave({option, file}).status, 2) << option;
    EXPECT_EQ(folder_.files(), before) << option;
  }
}

/// A device that takes nothing is known before the first shot, as a full disk is.
TEST_F(Outputs, ThatAreFullDevicesAreRefusedBeforeTheFirstShot) {
  for (const auto& [option, file] : OptionsAndFiles{{"--statistics", "/dev/full"},
                                                    {"--vcd", "/dev/full"},
                                                    {"--shots", "/dev/full"},
                                                    {"--plot", folder_ / "full.svg"}}) {
    const Finished refused = engrave({option, file});
    EXPECT_EQ(refused.status, 2) << option;
    EXPECT_THAT(refused.err, HasSubstr("error: " + file + ": cannot be written (No space left"));
    EXPECT_EQ(refused.out, "") << option;
    EXPECT_EQ(engrave({option, option == "--plot" ? folder_ / "m.svg" : "/dev/null"}).status, 0);
  }
}

constexpr rlim_t trial_bytes = 4096;  // of check_target(); the files of many points are larger

/// More than the JSON of a job, less than each of the files.
constexpr rlim_t max_json_bytes = 8192;

TEST_F(Outputs, ThatAreLostAfterTheShotsGiveOne) {
  list_ = folder_.write("many.xyz", xyz(walk(400, 1)));
  for (const auto& [option, name] :
       OptionsAndFiles{{"--vcd", "v.vcd"}, {"--shots", "s.csv"}, {"--plot", "m.svg"}}) {
    const std::string file = folder_ / name;
    const SizeLimit full(max_json_bytes);
    const Finished fired = engrave({option, file, "--json"});
    EXPECT_EQ(fired.status, 1) << option;
    EXPECT_THAT(fired.err,
                HasSubstr("error: " + file + ": the job was fired, but this file cannot be "));
    EXPECT_THAT(fired.err, HasSubstr("cannot be written (File too large)")) << option;
    EXPECT_THAT(fired.err, HasSubstr("do not run it a second time"));
    const Json json = Json::parse(fired.out, nullptr, false);
    EXPECT_EQ(json["end"], "done");
    EXPECT_EQ(json["points_fired"], 400);
    EXPECT_EQ(json["not_written"], Json::array({file}));
  }
}

#ifdef LAMPLOCK_HAS_FIRMWARE
/// As above, for the table of cycles, which only the chip has.
TEST_F(Outputs, TheLostTableOfCyclesGivesOne) {
  list_ = folder_.write("few.xyz", xyz(walk(8, 1)));
  const std::string file = folder_ / "t.txt";
  const SizeLimit full(max_json_bytes);
  const Finished fired = engrave({"--board", "chip", "--timing", file, "--json"});
  EXPECT_EQ(fired.status, 1);
  EXPECT_THAT(fired.err,
              HasSubstr("error: " + file + ": the job was fired, but this file cannot "));
  const Json json = Json::parse(fired.out, nullptr, false);
  EXPECT_EQ(json["points_fired"], 8);
  EXPECT_EQ(json["not_written"], Json::array({file}));
  EXPECT_THAT(folder_.files(), Not(testing::Contains("t.txt")));
}
#endif

/// The text about a lost file does not say that the whole job was fired.
TEST_F(Outputs, OfAJobThatFailsSayHowFarItCame) {
  std::string points;
  for (int i = 0; i < 300; ++i) points += fmt::format("{} 0 0\n", 0.005 * (i % 2));
  list_ = folder_.write("far.xyz", points + "40 0 0\n");  // too far for the slow machine
  const SizeLimit full(trial_bytes);
  const Finished failed = engrave({"--speed", "0.0002", "--vcd", folder_ / "v.vcd"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, testing::ContainsRegex(
                              "v.vcd: the job failed before point [0-9]+, but this file cannot"));
  EXPECT_THAT(failed.err, Not(HasSubstr("the job was fired")));
}

/// The disk is full after some kilobytes: the files that fit are whole, the others are not there.
TEST_F(Outputs, ThatAreTooLargeAreMissingAsAWhole) {
  constexpr std::size_t limit = 90'000;
  list_ = folder_.write("many.xyz", xyz(walk(2000, 1)));
  fs::create_directory(folder_ / "report");
  std::ofstream(folder_ / "report/cloud.png") << "of an older job";
  {
    const SizeLimit full(limit);
    const Finished fired = engrave({"--report", folder_ / "report", "--json"});
    EXPECT_EQ(fired.status, 1);
    EXPECT_THAT(fired.err, HasSubstr("report/cloud.png: the job was fired, but this file cannot be "
                                     "written (File too large)"));
    EXPECT_EQ(Json::parse(fired.out, nullptr, false)["not_written"].size(), 3u);
    EXPECT_THAT(fired.err, Not(HasSubstr("\nreport "))) << "it is not whole";
  }
  const auto files = Folder::files(folder_ / "report");
  for (const char* const whole : {"report.json", "shots.ply"})
    EXPECT_THAT(files, testing::Contains(whole));
  for (const char* const lost : {"report.html", "shots.csv", "cloud.png"})
    EXPECT_THAT(files, Not(testing::Contains(lost)));
  EXPECT_THAT(files, testing::Each(Not(HasSubstr(".part"))));
  EXPECT_EQ(Json::parse(read(folder_ / "report/report.json"))["points_fired"], 2000);
  EXPECT_GT(read(folder_ / "report/shots.ply").size(), 2000u * 17);
}

TEST_F(Outputs, OfANewLibraryOnAFullDiskAreNotLeftEmpty) {
  const std::string library = folder_ / "library.db";
  const Arguments add{"material", "add", "oak", "--library", library};
  {
    const SizeLimit full(trial_bytes);
    EXPECT_NE(run(add).status, 0);
    EXPECT_FALSE(fs::exists(library));
  }
  EXPECT_EQ(run(add).status, 0);
}

TEST_F(Outputs, OfProgramsAndSimulations) {
  const std::string program = folder_.write("p.ngc", "G21 G91\nG1 X1 F6000\nM2\n");
  for (const std::string option : {"--vcd", "--shots"}) {
    EXPECT_EQ(run({"send", program, option, "/dev/full"}).status, 2);
    EXPECT_EQ(run({"send", program, option, "/proc/x.csv"}).status, 2);
    EXPECT_EQ(run({"sim", "--seconds", "0.02", option, "/dev/full"}).status, 2);
    const std::string before = read(program);
    EXPECT_EQ(run({"send", program, option, program}).status, 2);
    EXPECT_EQ(read(program), before);
  }
  const std::string vcd = folder_ / "v.vcd";
  const SizeLimit full(trial_bytes);
  const Finished sent = run({"send", program, "--vcd", vcd, "--json"});
  EXPECT_EQ(sent.status, 1) << sent.err;
  EXPECT_THAT(sent.err, HasSubstr("error: " + vcd + ": the program was run, but"));
  EXPECT_EQ(Json::parse(sent.out, nullptr, false)["not_written"], Json::array({vcd}));
}

/// Runs the program in a shell, which redirects. Returns the exit status.
int status_in_shell(const std::string& arguments, const std::string& redirections) {
  const std::string line = program_path() + (" " + arguments + " " + redirections);
  const int status = std::system(line.c_str());  // NOLINT(cert-env33-c)
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

TEST_F(Outputs, OfEveryCommandToAFullDisk) {
  const std::string ball = folder_.write("ball.stl", octahedron_stl());
  const std::string program = folder_.write("p.ngc", "G21 G91\nG1 X1 F6000\nM2\n");
  const std::string picture = folder_.write("disc.bmp", disc_bmp(12));
  const std::string laser = folder_.write("laser.toml", "laser_mode = 1\n");
  const std::string drawing =
      folder_.write("d.dxf", lamplock::test::dxf_drawing(lamplock::test::dxf_circle(0, 0, 5)));
  const std::string job = folder_ / "j.llj", err = folder_ / "err";
  ASSERT_EQ(run({"job", list_, "-o", job}).status, 0);
  ASSERT_EQ(engrave({"--report", folder_ / "r"}).status, 0);
  const Arguments commands{
      "--help",
      "--version",
      "engrave --help",
      "engrave " + list_,
      "engrave --json " + list_,
      "estimate " + list_,
      "frame " + list_,
      "send " + job,
      "send " + program,
      "check " + program,
      "points " + ball + " --spacing 0.4 -o " + (folder_ / "o.xyz"),
      "order " + list_ + " -o " + (folder_ / "o.xyz"),
      "job " + list_ + " -o " + (folder_ / "o.llj"),
      "job --show " + job,
      "raster " + picture + " --feed 6000 --machine " + laser + " -o " + (folder_ / "r.llj"),
      "cut " + drawing + " --list",
      "cut " + drawing + " --power 9 --feed 600 -o " + (folder_ / "c.ngc"),
      "diagnose " + program,
      "compare " + (folder_ / "r") + " " + (folder_ / "r"),
      "example " + (folder_ / "e.stl"),
      "settings list",
      "settings get max_rate_x",
      "devices",
      "lines",
      "material list --library " + (folder_ / "library.db"),
      "material fit plywood --library " + (folder_ / "library.db"),
      "material export " + (folder_ / "m.toml") + " --library " + (folder_ / "library.db"),
      "operate status",
      "operate pulse",
      "console --board virtual </dev/null",
      "sim --seconds 0.01 --pty " + (folder_ / "pty"),
      "flash --help",
      "bench --help",
      "chip --help"};
  for (const std::string& command : commands) {
    EXPECT_EQ(status_in_shell(command, ">/dev/full 2>" + err), 1) << command;
    EXPECT_THAT(read(err), HasSubstr("error: standard output: cannot be written (No space"))
        << command;
  }
}

/// A point list, a job or a library of the user is not replaced by text of another kind.
TEST_F(Outputs, WithTheEndingOfAnotherKindAreRefused) {
  const std::string library = folder_ / "library.db";
  ASSERT_EQ(run({"material", "add", "oak", "--library", library}).status, 0);
  const std::string program = folder_.write("p.ngc", "G21 G91\nG1 X1 F6000\nM2\n");
  const std::string drawing =
      folder_.write("d.dxf", lamplock::test::dxf_drawing(lamplock::test::dxf_circle(0, 0, 5)));
  const Arguments cut{"cut", drawing, "--power", "9", "--feed", "600", "-o"};
  const std::vector<std::pair<Arguments, std::string>> outputs{
      {{"settings", "backup"}, "k.llj"},
      {{"settings", "backup"}, "out.json"},
      {{"material", "export", "--library", library}, "out.db"},
      {{"engrave", list_, "--shots"}, "c.xyz"},
      {{"engrave", list_, "--vcd"}, "c.llj"},
      {{"engrave", list_, "--progress"}, "c.stl"},
      {{"send", program, "--statistics"}, "c.ply"},
      {{"sim", "--seconds", "0.01", "--shots"}, "c.ngc"},
      {{"estimate", list_, "--page"}, "z.png"},
      {{"heat", program, "--csv"}, "z.toml"},
      {{"jerk", list_, "-o"}, "c.xyz"},
      {{"jerk", list_, "--points"}, "c.ngc"},
      {{"raster", folder_.write("d.bmp", disc_bmp(12)), "--feed", "600", "--gcode"}, "c.toml"},
      {cut, "c.xyz"},
      {cut, "c.STL"}};
  for (const auto& [command, name] : outputs) {
    const std::string file = folder_.write(name, "mine\n");
    Arguments all = command;
    all.push_back(file);
    const Finished refused = run(all);
    EXPECT_EQ(refused.status, 2) << command[0] << ' ' << name;
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: " + file +
                                                   ": '[^\n]+' is the ending of another file type"
                                                   "; give a name that ends in [^\n]+\n"));
    EXPECT_EQ(read(file), "mine\n");
  }
  EXPECT_EQ(run({"settings", "backup", folder_ / "board"}).status, 0);
  EXPECT_EQ(run({"engrave", list_, "--shots", folder_ / "s.txt"}).status, 0);
}

/// The next file that the program opens must not become its standard output.
TEST_F(Outputs, OfACallerThatHasClosedStandardOutput) {
  const std::string vcd = folder_ / "v.vcd", err = folder_ / "err";
  EXPECT_EQ(status_in_shell("engrave " + list_ + " --vcd " + vcd, "<&- >&- 2>" + err), 1);
  EXPECT_THAT(read(err), HasSubstr("error: standard output: cannot be written"));
  EXPECT_THAT(read(vcd), testing::StartsWith("$"));
  EXPECT_THAT(read(vcd), Not(HasSubstr("points")));
  EXPECT_EQ(status_in_shell("engrave " + list_ + " --vcd " + vcd, "<&- >/dev/null 2>&-"), 0);
  EXPECT_THAT(read(vcd), testing::StartsWith("$"));
}

/// The messages of a command, or its document, would be mixed with the output.
TEST_F(Outputs, AreNotTheStandardOutput) {
  const std::string linked = folder_ / "out.xyz", got = folder_ / "got";
  const std::string order = fmt::format("order {} -o {}", list_, linked);
  constexpr const char* refusal = "is the standard output, to which this command prints";
  fs::create_symlink("/proc/self/fd/1", linked);
  for (const char* to : {">", ">>"}) {
    EXPECT_EQ(status_in_shell(order, fmt::format("{0}{1} 2>{1}", to, got)), 2) << to;
    EXPECT_THAT(read(got), HasSubstr(refusal));
  }
  EXPECT_EQ(status_in_shell(order + " --json", fmt::format("2>{} | cat", got)), 0);
  EXPECT_THAT(read(got), HasSubstr(refusal));
  EXPECT_EQ(status_in_shell(order, fmt::format("2>&1 | grep -c '^[-0-9]' >{}", got)), 0);
  EXPECT_EQ(read(got), "60\n");
  EXPECT_TRUE(fs::is_symlink(linked));
}

}  // namespace
}  // namespace lamplock::cli::test::outputs
