// `lamplock raster`: from a picture to rows, as a job and as G-code; refusals; sending its job.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using Arguments = std::vector<std::string>;

const std::string laser = lamplock::test::in_repository("examples/laser.toml");

/// Options for 20 mm at 100 mm/s.
Arguments raster(const std::string& picture, const Arguments& more) {
  Arguments all{"raster", picture, "--machine", laser, "--width-mm", "20", "--feed", "6000"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string disc(const Folder& folder) { return folder.write("disc.bmp", disc_bmp(40)); }

TEST(Raster, makes_a_job_and_the_same_as_gcode) {
  const Folder folder;
  const std::string job = folder / "rows.llj", text = folder / "rows.ngc";
  const Finished made = run(raster(disc(folder), {"-o", job, "--gcode", text, "--json"}));
  ASSERT_EQ(made.status, 0) << made.err;
  const auto document = nlohmann::json::parse(made.out);
  EXPECT_EQ(document["columns"], 40);
  EXPECT_EQ(document["rows"], 40);
  EXPECT_DOUBLE_EQ(document["pitch_mm"], 0.5);
  EXPECT_NEAR(document["overscan_mm"].get<double>(), 2.5, 1e-6);
  EXPECT_EQ(document["lines"], 80);
  EXPECT_EQ(document["output"]["bytes"], read(job).size());
  EXPECT_EQ(document["gcode"]["bytes"], read(text).size());
  EXPECT_EQ(read(text).find_first_of("*:"), std::string::npos) << "words that grbl lacks";
  const Finished shown = run({"job", "--show", job, "--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const auto show = nlohmann::json::parse(shown.out);
  EXPECT_EQ(show["mode"], "rows");
  EXPECT_EQ(show["lines"], 80);
  EXPECT_EQ(show["bounds"], document["bounds"]);
  const Finished checked = run({"check", text, "--machine", laser, "--json"});
  ASSERT_EQ(checked.status, 0) << checked.err;
  EXPECT_NEAR(nlohmann::json::parse(checked.out)["time_s"].get<double>(),
              document["seconds"].get<double>(), 0.05 * document["seconds"].get<double>() + 1);
}

TEST(Raster, options_do_what_they_say) {
  const Folder folder;
  const std::string picture = disc(folder);
  const auto document = [&](const Arguments& more) {
    Arguments all = raster(picture, {"-o", folder / "a.llj", "--json"});
    all.insert(all.end(), more.begin(), more.end());
    const Finished made = run(all);
    EXPECT_EQ(made.status, 0) << made.err;
    return nlohmann::json::parse(made.out);
  };
  const auto plain = document({});
  const auto fine = document({"--pitch-mm", "0.1"});
  EXPECT_EQ(fine["columns"], 200);
  EXPECT_EQ(fine["lines"], 400);
  const Finished wider = run(raster(picture, {"-o", folder / "b.llj", "--pitch-mm", "3"}));
  EXPECT_THAT(wider.err, HasSubstr("--width-mm 20 is not a whole number of pixels of 3 mm"));
  EXPECT_THAT(wider.err, HasSubstr("the picture is 21 mm wide"));
  const auto beside = document({"--overscan-mm", "0.6"});
  EXPECT_EQ(beside["overscan_mm"], 1.0) << "whole pixels of 0.5 mm";
  EXPECT_EQ(beside["bounds"]["low_mm"][0], -11.0);
  const auto one_way = document({"--one-way"});
  EXPECT_GT(one_way["seconds"].get<double>(), 1.2 * plain["seconds"].get<double>());
  const auto moved = document({"--origin", "-40,-30,-2", "--overscan-mm", "0"});
  EXPECT_EQ(moved["bounds"]["low_mm"], (nlohmann::json{-40.0, -29.75, -2.0}));
  EXPECT_EQ(moved["bounds"]["high_mm"], (nlohmann::json{-20.0, -10.25, -2.0}));
  // Eight rows through the middle of the disc do not reach beyond it.
  EXPECT_EQ(document({"--invert"})["lines"], 64);
}

/// The G-code of a dry run is dark too, and goes the same way.
TEST(Raster, dry_programs_are_dark) {
  const Folder folder;
  const std::string picture = disc(folder), job = folder / "a.llj";
  for (const Arguments& form : {Arguments{}, Arguments{"--power-lists"}}) {
    const auto program = [&](const std::string& name, const Arguments& more) {
      Arguments all = raster(picture, {"-o", job, "--gcode", folder / name});
      for (const Arguments& some : {form, more}) all.insert(all.end(), some.begin(), some.end());
      EXPECT_EQ(run(all).status, 0);
      const Finished checked = run({"check", folder / name, "--machine", laser, "--json"});
      EXPECT_EQ(checked.status, 0) << checked.err;
      return nlohmann::json::parse(checked.out);
    };
    const auto lit = program("lit.ngc", {}), dark = program("dark.ngc", {"--dry"});
    const std::string text = read(folder / "dark.ngc");
    EXPECT_EQ(text.find('S'), std::string::npos) << text.substr(0, 200);
    EXPECT_EQ(text.find("M3"), std::string::npos);
    EXPECT_EQ(text.find("M4"), std::string::npos);
    EXPECT_EQ(dark["low_mm"], lit["low_mm"]);
    EXPECT_EQ(dark["high_mm"], lit["high_mm"]);
    EXPECT_NEAR(dark["time_s"].get<double>(), lit["time_s"].get<double>(), 0.5);
  }
}

TEST(Raster, refuses_invalid_options) {
  const Folder folder;
  const std::string picture = disc(folder), out = folder / "a.llj";
  const auto refused = [&](const Arguments& arguments) {
    const Finished wrong = run(arguments);
    EXPECT_EQ(wrong.status, 2) << wrong.out;
    EXPECT_EQ(lines(wrong.err).size(), 1u) << wrong.err;
    return wrong.err;
  };
  EXPECT_THAT(refused(raster(picture, {})), HasSubstr("-o FILE.llj or --gcode"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--gcode", out})), HasSubstr("--gcode"));
  EXPECT_THAT(refused(raster(picture, {"-o", folder / "no/a.llj"})), HasSubstr("folder"));
  EXPECT_THAT(refused(raster(folder / "none.png", {"-o", out})), HasSubstr("none.png"));
  EXPECT_THAT(refused(raster(folder.write("a.png", "text"), {"-o", out})), HasSubstr("PNG"));
  EXPECT_THAT(refused({"raster", picture, "-o", out}), HasSubstr("--feed"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--pitch-mm", "0.01"})), HasSubstr("step of X"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--pitch-mm", "0"})), HasSubstr("--pitch-mm"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--power-max", "101"})), HasSubstr("--power"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--power-min", "60", "--power-max", "50"})),
              HasSubstr("lower one first"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--origin", "48,0"})), HasSubstr("work space"));
  EXPECT_THAT(refused(raster(picture, {"-o", out, "--origin", "1"})), HasSubstr("--origin"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// A laser machine as in examples/laser.toml, with other values.
std::string other_laser(const Folder& folder, const std::string& name, const char* changes) {
  return folder.write(name, std::string("axes = 3\ntravel = [100, 100, 50]\n"
                                        "min_corner = [-50, -50, -50]\n") +
                                changes);
}

TEST(Raster, rows_need_the_profile_of_a_continuous_laser) {
  const Folder folder;
  const std::string picture = disc(folder), out = folder / "a.llj", text = folder / "a.ngc";
  const std::string pulsed = other_laser(folder, "pulsed.toml", "steps_per_mm = [80, 80, 400]\n");
  const Arguments bare{"raster", picture, "--width-mm", "20", "--feed", "6000"};
  const auto refused = [&](const Arguments& more, const char* names) {
    Arguments all = bare;
    all.insert(all.end(), more.begin(), more.end());
    const Finished wrong = run(all);
    EXPECT_EQ(wrong.status, 2);
    EXPECT_EQ(lines(wrong.err).size(), 1u) << wrong.err;
    EXPECT_THAT(wrong.err, HasSubstr(names));
    EXPECT_THAT(wrong.err, HasSubstr("laser_mode = 1"));
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  refused({"-o", out}, "--machine FILE.toml");
  refused({"-o", out, "--gcode", text, "--dry"}, "continuous");
  refused({"-o", out, "--machine", pulsed}, "pulsed.toml");
  Arguments gcode = bare;
  gcode.insert(gcode.end(), {"--gcode", text});
  EXPECT_EQ(run(gcode).status, 0) << "G-code is for boards of any kind";
}

/// A board at the end of a port, and the same machine as the virtual board.
TEST(Raster, refusals_name_both_values_on_a_port_and_on_the_virtual_board) {
  const Folder folder;
  const std::string port = folder / "port", job = folder / "rows.llj";
  const std::string machine =
      other_laser(folder, "m.toml", "steps_per_mm = [100, 80, 400]\nlaser_mode = 1\n");
  const std::string pulsed =
      other_laser(folder, "p.toml",
                  "steps_per_mm = [80, 80, 400]\nmax_rate = [12000, 12000, 600]\n"
                  "acceleration = [2000, 2000, 200]\n");
  ASSERT_EQ(run(raster(disc(folder), {"-o", job})).status, 0);
  const auto refusal = [&](const Arguments& board) {
    Arguments all{"send", job, "--yes", "--board"};
    all.insert(all.end(), board.begin(), board.end());
    const Finished wrong = run(all);
    EXPECT_EQ(wrong.status, 2) << wrong.err;
    return wrong.err;
  };
  const auto steps = HasSubstr("the job is for steps_per_mm_x = 80 step/mm, the board has 100");
  const auto kind = HasSubstr("set up for a pulsed laser (laser_mode = 0)");
  EXPECT_THAT(refusal({"virtual", "--machine", machine}), steps);
  EXPECT_THAT(refusal({"virtual", "--machine", pulsed}), kind);
  Running sim({"sim", "--pty", port, "--machine", machine});
  ASSERT_TRUE(sim.wait_for("listening"));
  EXPECT_THAT(refusal({port}), steps);
  // What the message advises.
  const std::string board = folder / "board.toml";
  ASSERT_EQ(run({"settings", "backup", board, "--board", port}).status, 0);
  const Arguments again{"raster", disc(folder), "--machine", board, "--width-mm",
                        "1",      "--feed",     "6000",      "-o",  job};
  ASSERT_EQ(run(again).status, 0);
  const Finished sent = run({"send", job, "--yes", "--board", port});
  EXPECT_EQ(sent.status, 0) << sent.err;
  ASSERT_EQ(run({"settings", "set", "laser_mode=0", "--board", port}).status, 0);
  EXPECT_THAT(refusal({port}), HasSubstr("lamplock settings set laser_mode=1 --board " + port));
}

TEST(Raster, its_job_is_sent) {
  const Folder folder;
  const std::string job = folder / "rows.llj";
  ASSERT_EQ(run(raster(disc(folder), {"-o", job})).status, 0);
  const Finished sent = run({"send", job, "--board", "virtual", "--json"});
  ASSERT_EQ(sent.status, 0) << sent.err;
  const auto document = nlohmann::json::parse(sent.out);
  EXPECT_EQ(document["end"], "done");
  EXPECT_EQ(document["mode"], "rows");
  EXPECT_EQ(document["lines"], 80);
  EXPECT_EQ(document["first_unfired"], 80);
  EXPECT_EQ(document["starvations"], 0);
  EXPECT_NEAR(document["seconds"].get<double>(), document["planned_seconds"].get<double>(),
              0.05 * document["planned_seconds"].get<double>() + 1);
  const Finished rest =
      run({"send", job, "--board", "virtual", "--from", "61", "--job-speed", "50", "--json"});
  ASSERT_EQ(rest.status, 0) << rest.err;
  const auto part = nlohmann::json::parse(rest.out);
  EXPECT_EQ(part["first_unfired"], 80);
  const double part_s = part["planned_seconds"].get<double>();
  EXPECT_NEAR(part["seconds"].get<double>(), part_s, 0.05 * part_s + 1);
  // A quarter of the lines at half the feed; a rapid keeps its speed.
  const double whole_s = document["planned_seconds"].get<double>();
  EXPECT_GT(part_s, 0.25 * whole_s);
  EXPECT_LT(part_s, 0.5 * whole_s);
  for (const char* option : {"--report", "--shots", "--plot"}) {
    const Finished wrong =
        run({"send", job, option, folder / (option == std::string("--shots") ? "x.csv" : "x.svg")});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr(option));
  }
  EXPECT_THAT(run({"send", job, "--from", "80"}).err, HasSubstr("the job has 80 lines"));
}

}  // namespace
}  // namespace lamplock::cli::test
