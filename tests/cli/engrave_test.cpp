// Whole runs on the virtual board.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/model/read_points.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::MatchesRegex;

/// Half a step of the default machine (200 steps/mm).
constexpr double half_step_mm = 0.0025;

/// Every point was fired once.
void expect_each_once(const Json& report) {
  EXPECT_EQ(report["shots"], report["points"]);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["doubled"], 0);
  EXPECT_EQ(report["end"], "done");
  EXPECT_EQ(report["first_unfired"], report["points"]);
}

void expect_exactly(const std::vector<geometry::Point>& shots,
                    const std::vector<geometry::Point>& wanted) {
  ASSERT_EQ(shots.size(), wanted.size());
  for (std::size_t i = 0; i < shots.size(); ++i) {
    EXPECT_NEAR(shots[i].x, wanted[i].x, half_step_mm + 1e-9) << i;
    EXPECT_NEAR(shots[i].y, wanted[i].y, half_step_mm + 1e-9) << i;
    EXPECT_NEAR(shots[i].z, wanted[i].z, half_step_mm + 1e-9) << i;
  }
}

TEST(Engrave, mesh) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const Json report = run_json(
      {"engrave", mesh, "--size", "6", "--spacing", "0.3", "--report", folder / "out/report"});
  expect_each_once(report);
  // Blue noise has 0.7 points per area of spacing^2; the octahedron has sqrt(3) size^2.
  EXPECT_NEAR(report["points"].get<double>(), 0.7 * std::sqrt(3) * 36 / 0.09, 50);
  EXPECT_LE(report["largest_error_steps"], 0.5);
  for (const geometry::Point& p : read_shots(folder / "out/report/shots.csv"))
    EXPECT_NEAR(std::abs(p.x) + std::abs(p.y) + std::abs(p.z), 3, 0.01);  // on the surface
  EXPECT_EQ(Folder::files(folder.path() / "out"), std::vector<std::string>{"report"});
  EXPECT_EQ(Folder::files(folder.path() / "out/report"),
            (std::vector<std::string>{"cloud.png", "job.toml", "report.html", "report.json",
                                      "shots.csv", "shots.ply"}));
  EXPECT_THAT(read(folder / "out/report/cloud.png"), testing::StartsWith("\x89PNG"));
}

TEST(Engrave, mesh_by_slices) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const Json report =
      run_json({"engrave", mesh, "--size", "6", "--spacing", "0.3", "--method", "slice"});
  expect_each_once(report);
  EXPECT_GT(report["points"], 500);
}

TEST(Engrave, mesh_by_rays) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  expect_each_once(run_json({"engrave", mesh, "--size", "4", "--spacing", "0.3", "--method", "rays",
                             "--direction", "x"}));
}

TEST(Engrave, bitmap) {
  const Folder folder;
  const std::string bitmap = folder.write("d.bmp", disc_bmp(20));
  const Json report = run_json({"engrave", bitmap, "--size", "4", "--spacing", "0.2", "--layers",
                                "2", "--layer", "0.5", "--shots", folder / "shots.csv"});
  expect_each_once(report);
  EXPECT_NEAR(report["points"].get<double>(), 2 * M_PI / 4 * 20 * 20, 50);
  for (const geometry::Point& p : read_shots(folder / "shots.csv")) {
    // In a pixel of 0.2 mm whose middle is in the disc: layers are offset against each other.
    EXPECT_LT(std::hypot(p.x, p.y), 2 + std::hypot(0.1, 0.1));
    EXPECT_EQ(std::abs(p.z), 0.25);
  }
}

TEST(Engrave, point_list_exactly_as_given) {
  const Folder folder;
  std::vector<geometry::Point> points = walk(300, 7);
  points[100] = points[99];  // must not be welded
  const std::string list = folder.write("p.xyz", xyz(points));
  for (const char* mode : {"free", "path", "start-stop"}) {
    expect_each_once(run_json(
        {"engrave", list, "--order", "given", "--mode", mode, "--shots", folder / "shots.csv"}));
    expect_exactly(read_shots(folder / "shots.csv"), points);
  }
}

TEST(Engrave, point_list_by_layers_only_on_request) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "0 0 1\n0 0 -1\n0 0 0\n");
  run_json({"engrave", list, "--shots", folder / "given.csv"});
  EXPECT_EQ(read_shots(folder / "given.csv")[0].z, 1);
  run_json({"engrave", list, "--order", "layers", "--shots", folder / "layers.csv"});
  const auto shots = read_shots(folder / "layers.csv");
  EXPECT_EQ(shots[0].z, -1);
  EXPECT_EQ(shots[2].z, 1);
}

TEST(Engrave, the_rest_of_a_job) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(200, 3);
  const std::string list = folder.write("p.xyz", xyz(points));
  const Json report = run_json({"engrave", list, "--from", "150", "--shots", folder / "shots.csv"});
  EXPECT_EQ(report["points"], 50);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["first_unfired"], 200);
  expect_exactly(read_shots(folder / "shots.csv"), {points.begin() + 150, points.end()});
}

/// A rerun of a saved description would fire what these options leave out.
TEST(Engrave, options_of_a_run_are_not_saved) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", "0 0 0\n1 0 0\n2 0 0\n");
  const std::string saved = folder / "s.toml", job = folder / "j.llj";
  using Words = std::vector<std::string>;
  const std::vector<Words> runs{
      {"--dry"}, {"--origin", "zero"}, {"--from", "1"}, {"--fired", "1"}, {"--resume"}};
  for (const Words& options : runs) {
    Words words{"engrave", points, "--save", saved};
    words.insert(words.end(), options.begin(), options.end());
    const Finished refused = run(words);
    EXPECT_EQ(refused.status, 2) << options[0];
    EXPECT_THAT(refused.err, HasSubstr("error: " + options[0]));
    EXPECT_FALSE(std::filesystem::exists(saved)) << options[0];
  }
  const Finished refused = run({"job", points, "--dry", "--save", saved, "-o", job});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--dry: is not saved in a description; leave it out"));
  EXPECT_THAT(Folder::files(folder.path()), testing::ElementsAre("p.xyz"));
}

TEST(Engrave, the_description_in_a_report_names_the_options_of_its_run) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", "0 0 0\n1 0 0\n2 0 0\n");
  run_json({"engrave", points, "--dry", "--origin", "zero", "--report", folder / "r"});
  const std::string description = read(folder / "r/job.toml");
  EXPECT_THAT(description, HasSubstr("without --dry this description fires"));
  EXPECT_THAT(description, HasSubstr("a run with --origin zero"));
  // The comment does not spoil it.
  EXPECT_EQ(run_json({"engrave", folder / "r/job.toml", "--dry"})["points"], 3);
}

TEST(Engrave, several_flashes_at_each_point) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(60, 3);
  const std::string list = folder.write("p.xyz", xyz(points));
  std::vector<geometry::Point> thrice;
  for (const geometry::Point& p : points) thrice.insert(thrice.end(), 3, p);
  const Json report =
      run_json({"engrave", list, "--flashes", "3", "--shots", folder / "shots.csv"});
  EXPECT_EQ(report["points"], 60);
  EXPECT_EQ(report["shots"], 180);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["doubled"], 0);
  expect_exactly(read_shots(folder / "shots.csv"), thrice);
  // The same as a job file, and the rest of it after one flash of point 20.
  const std::string job = folder / "job.llj";
  ASSERT_EQ(run({"job", list, "--flashes", "3", "-o", job}).status, 0);
  const Json rest =
      run_json({"send", job, "--from", "20", "--fired", "1", "--shots", folder / "rest.csv"});
  EXPECT_EQ(rest["shots"], 119);
  EXPECT_EQ(rest["missed"], 0);
  EXPECT_EQ(rest["doubled"], 0);
  expect_exactly(read_shots(folder / "rest.csv"), {thrice.begin() + 61, thrice.end()});
}

TEST(Engrave, job_speed_costs_beats_and_nothing_else) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(100, 3);
  const std::string list = folder.write("p.xyz", xyz(points));
  std::vector<int> beats;
  for (const char* speed : {"100", "50", "20"}) {
    const Json report = run_json(
        {"engrave", list, "--lamp", "200", "--job-speed", speed, "--shots", folder / "shots.csv"});
    expect_each_once(report);
    expect_exactly(read_shots(folder / "shots.csv"), points);
    beats.push_back(report["beats"]);
  }
  EXPECT_GT(beats[1], 3 * beats[0] / 2);
  EXPECT_GT(beats[2], 2 * beats[1]);
  EXPECT_EQ(run({"frame", list, "--job-speed", "30"}).status, 0);
}

TEST(Engrave, dry_moves_and_never_fires) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(100, 3)));
  const Json report = run_json({"engrave", list, "--dry", "--shots", folder / "shots.csv"});
  EXPECT_EQ(report["shots"], 0);
  EXPECT_EQ(report["dry"], true);
  EXPECT_EQ(report["first_unfired"], nullptr);
  EXPECT_TRUE(read_shots(folder / "shots.csv").empty());
}

TEST(Engrave, lamp_modes_and_overrides) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(100, 3)));
  const std::string machine = folder.write("m.toml", "lamp_energy = 1\n");
  for (const char* mode : {"slave", "master", "none"}) {
    const Json report = run_json({"engrave", list, "--machine", machine, "--lamp-mode", mode,
                                  "--lamp", "50", "--accel", "2.5", "--speed", "0.5"});
    expect_each_once(report);
    EXPECT_LE(report["largest_jitter_error_steps"], 0.5) << mode;
    EXPECT_EQ(report["settings"]["lamp_frequency"], 50);
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_EQ(report["settings"][std::string("acceleration_") + axis], 2500);
      EXPECT_EQ(report["settings"][std::string("max_rate_") + axis], 30000);
    }
  }
}

TEST(Engrave, faults_of_the_lamp_cost_beats_never_points) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(400, 3)));
  const Json clean = run_json({"engrave", list});
  std::vector<std::string> arguments{"engrave",    list, "--jitter", "20", "--wander", "1",
                                     "--dropouts", "5",  "--runts",  "10", "--seed",   "5"};
  const Json faulty = run_json(arguments);
  expect_each_once(faulty);
  EXPECT_GT(faulty["beats"], clean["beats"]);
  EXPECT_GT(faulty["beats_by_reason"]["no_edge"], 0);
  arguments.back() = std::string("6");
  const Json other = run_json(arguments);
  EXPECT_NE(other["beats_by_reason"], faulty["beats_by_reason"]);
}

TEST(Engrave, drives_whose_lag_is_not_set) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(100, 3)));
  EXPECT_LE(run_json({"engrave", list})["largest_error_steps"], 0.5);
  for (const char* lag : {"900", "0,900", "0,0,900"})
    EXPECT_GT(run_json({"engrave", "--drive-lag", lag, list})["largest_error_steps"], 1) << lag;
}

TEST(Engrave, trace_of_the_pins) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 3)));
  run_json({"engrave", list, "--vcd", folder / "a.vcd"});
  EXPECT_THAT(read(folder / "a.vcd"), HasSubstr("q_switch"));
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.vcd", "p.xyz"}));
}

TEST(Engrave, a_profile_moves_the_middle) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::string profile = folder.write(
      "m.toml", "min_corner = [0, 0, 0]\ntravel = [20, 20, 10]\nsteps_per_mm = [400, 400, 400]\n");
  expect_each_once(run_json({"engrave", mesh, "--size", "4", "--spacing", "0.5", "--machine",
                             profile, "--shots", folder / "shots.csv"}));
  for (const geometry::Point& p : read_shots(folder / "shots.csv"))
    EXPECT_NEAR(std::abs(p.x - 10) + std::abs(p.y - 10) + std::abs(p.z - 5), 2, 0.01);
}

TEST(Engrave, summary_for_people) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 3)));
  const Finished finished = run({"engrave", list});
  EXPECT_EQ(finished.status, 0);
  for (const char* text : {"points   20 in x", "order    as given", "beats per point", "missed"})
    EXPECT_THAT(finished.out, HasSubstr(text));
}

TEST(Engrave, reports_side_by_side) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(200, 3)));
  const std::string stop = folder / "stop", free = folder / "free";
  const Json a = run_json({"engrave", list, "--mode", "start-stop", "--report", stop});
  const Json b = run_json({"engrave", list, "--mode", "free", "--report", free});
  const Json both = run_json({"compare", stop, free});
  EXPECT_EQ(both["first"]["beats"], a["beats"]);
  EXPECT_EQ(both["second"]["mode"], "free");
  EXPECT_EQ(both["second"]["settings"], b["settings"]);
  EXPECT_DOUBLE_EQ(both["beats_ratio"], b["beats"].get<double>() / a["beats"].get<double>());
  const std::string table = run({"compare", stop + "/", free + "/report.json"}).out;
  EXPECT_THAT(table, HasSubstr("beats, ratio"));
  EXPECT_THAT(lines(table)[0], MatchesRegex(" +stop +free"));
  EXPECT_EQ(both["differing_settings"], Json::object());
  const std::string faster = folder / "b/free";
  run_json({"engrave", list, "--lamp", "130", "--report", faster});
  const Json other = run_json({"compare", free, faster});
  EXPECT_EQ(other["differing_settings"], (Json{{"lamp_frequency", {100.0, 130.0}}}));
  const std::string differing = run({"compare", free, faster}).out;
  EXPECT_THAT(differing, HasSubstr("b/free"));
  EXPECT_THAT(differing, ContainsRegex("lamp_frequency +100 Hz +130 Hz"));
}

TEST(Engrave, the_folder_of_a_report_has_what_repeats_the_job) {
  const Folder folder;
  const std::string mesh = folder.write("my model.stl", octahedron_stl()), first = folder / "one";
  const Json made =
      run_json({"engrave", mesh, "--size", "6", "--spacing", "0.5", "--method", "slice",
                "--material", "bk7", "--report", first, "--shots", folder / "a.csv"});
  EXPECT_EQ(made["spacing_mm"], 0.5);
  EXPECT_EQ(made["method"], "slice");
  EXPECT_EQ(made["order"], "best");
  EXPECT_EQ(made["material"], "bk7");
  ASSERT_EQ(made["size_mm"].size(), 3u);
  for (const Json& side : made["size_mm"]) EXPECT_NEAR(side.get<double>(), 6, 1);
  EXPECT_THAT(made["command"].get<std::string>(),
              HasSubstr("lamplock engrave '" + mesh + "' --size 6 --spacing 0.5"));
  EXPECT_EQ(Json::parse(read(first + "/report.json"))["command"], made["command"]);
  const Json again = run_json({"engrave", first + "/job.toml", "--shots", folder / "b.csv"});
  EXPECT_EQ(again["beats"], made["beats"]);
  EXPECT_EQ(read(folder / "a.csv"), read(folder / "b.csv"));
}

TEST(Commands, points_order_job_send_give_what_engrave_gives) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::vector<std::string> size{"--size", "5", "--spacing", "0.4"};
  const auto with_size = [&size](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), size.begin(), size.end());
    return arguments;
  };
  const Json made = run_json(with_size({"points", mesh, "-o", folder / "p.ply"}));
  const auto points = model::read_point_list(folder / "p.ply");
  EXPECT_EQ(made["points"], points.size());
  EXPECT_NEAR(made["bounds"]["high_mm"][0], 2.5, 0.4);
  run_json({"order", folder / "p.ply", "--layer", "0.4", "-o", folder / "o.xyz"});
  EXPECT_EQ(run({"job", folder / "o.xyz", "-o", folder / "j.llj"}).status, 0);
  const Json shown = run_json({"job", "--show", folder / "j.llj"});
  EXPECT_EQ(shown["points"], points.size());
  EXPECT_EQ(shown["mode"], "free");
  expect_each_once(run_json({"send", folder / "j.llj", "--shots", folder / "sent.csv"}));
  expect_each_once(run_json(with_size({"engrave", mesh, "--shots", folder / "engraved.csv"})));
  EXPECT_EQ(read(folder / "sent.csv"), read(folder / "engraved.csv"));
  EXPECT_THAT(folder.files(), testing::Not(testing::Contains(HasSubstr(".part"))));
}

TEST(Commands, example_engraves) {
  const Folder folder;
  EXPECT_EQ(run({"example", folder / "e.stl"}).status, 0);
  expect_each_once(run_json({"engrave", folder / "e.stl", "--size", "20", "--spacing", "1"}));
}

TEST(Commands, frame_goes_round_and_never_fires) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "-1 -2 3\n4 5 6\n");
  const Json frame = run_json({"frame", list});
  EXPECT_EQ(frame["done"], true);
  EXPECT_EQ(frame["bounds"]["low_mm"], Json({-1, -2, 3}));
  EXPECT_EQ(frame["bounds"]["high_mm"], Json({4, 5, 6}));
}

TEST(Commands, frame_goes_round_all_layers_of_a_drawing) {
  const Folder folder;
  const std::string svg = folder.write(
      "d.svg",
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20mm\" height=\"10mm\" "
      "viewBox=\"0 0 20 10\"><path fill=\"none\" stroke=\"red\" d=\"M0 0 H20 V10\"/></svg>");
  for (const auto& how :
       std::vector<std::vector<std::string>>{{},
                                             {"--layers", "5", "--layer", "0.8"},
                                             {"--layers", "3", "--transform", "rotate z 90"},
                                             {"--layers", "4", "--layer", "2", "--size", "8"}}) {
    std::vector<std::string> points{"points", svg, "--spacing", "0.5", "-o", folder / "o.xyz"};
    std::vector<std::string> frame{"frame", svg, "--spacing", "0.5"};
    for (auto* arguments : {&points, &frame})
      arguments->insert(arguments->end(), how.begin(), how.end());
    EXPECT_EQ(run_json(frame)["bounds"], run_json(points)["bounds"]) << how.size();
  }
}

TEST(Commands, outputs_that_are_one_file) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 3)));
  const std::string job = folder / "j.llj", one = folder / "one.csv", toml = folder / "t.toml";
  ASSERT_EQ(run({"job", list, "-o", job}).status, 0);
  const auto before = folder.files();
  const std::string points = read(list);
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"engrave", list, "--save", toml, "--statistics", toml},
           {"engrave", list, "--save", toml, "--shots", folder.path().string() + "/./t.toml"},
           {"engrave", list, "--shots", one, "--vcd", one},
           {"engrave", list, "--shots", folder / "r/shots.csv", "--report", folder / "r"},
           {"engrave", list, "--shots", list},
           {"send", job, "--shots", job},
           {"send", job, "--shots", one, "--statistics", one},
           {"job", list, "-o", toml, "--save", toml},
           {"points", list, "-o", folder / "q.xyz", "--save", folder / "q.xyz"},
           {"estimate", list, "--page", list},
           {"sim", "--seconds", "0.1", "--vcd", one, "--shots", one}}) {
    const Finished refused = run(arguments);
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
  }
  EXPECT_EQ(folder.files(), before);
  EXPECT_EQ(read(list), points);
}

}  // namespace
}  // namespace lamplock::cli::test
