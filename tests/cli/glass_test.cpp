// Blocks of glass: descriptions, refraction, margins, pauses, several objects, every method.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/job/job_file.hpp"
#include "host/model/read_points.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"
#include "tests/cli/shots.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double index_of_k9 = 1.5168;
/// Half a step of the default machine (200 steps/mm), plus rounding.
constexpr double rounded_half_step_mm = 0.0025 + 1e-9;

std::vector<std::string> joined(std::vector<std::string> words,
                                const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void expect_glass_refused(const Folder& folder, const std::vector<std::string>& arguments,
                          const std::vector<std::string>& names) {
  const auto before = folder.files();
  const Finished refused = run(arguments);
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
  for (const std::string& name : names) EXPECT_THAT(refused.err, HasSubstr(name));
  EXPECT_EQ(folder.files(), before);
}

TEST(Glass, ShotsAreInTheGlassAndTheStageIsNot) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(150, 5);
  const std::string list = folder.write("p.xyz", xyz(points));
  const std::vector<std::string> glass{list, "--material", "k9", "--block", "20,20,30"};
  const Json report = run_json(joined({"engrave", "--shots", folder / "shots.csv"}, glass));
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["doubled"], 0);
  EXPECT_LE(report["largest_error_steps"], 0.5 + 1e-9);
  const auto shots = read_shots(folder / "shots.csv");
  ASSERT_EQ(shots.size(), points.size());
  for (std::size_t i = 0; i < shots.size(); ++i) {
    EXPECT_NEAR(shots[i].x, points[i].x, rounded_half_step_mm);
    EXPECT_NEAR(shots[i].z, points[i].z, rounded_half_step_mm * index_of_k9);
  }
  // The entry face is at 15 mm; the stage moves less far below it.
  ASSERT_EQ(run(joined({"job", "-o", folder / "j.llj"}, glass)).status, 0);
  const job::Job job = job::read_job_file(folder / "j.llj");
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(job.targets[i].steps[2] / 200.0, 15 + (points[i].z - 15) / index_of_k9,
                rounded_half_step_mm);
  // A job file has its glass.
  run_json({"send", folder / "j.llj", "--shots", folder / "sent.csv"});
  EXPECT_EQ(read(folder / "sent.csv"), read(folder / "shots.csv"));
}

TEST(Glass, BlocksKeepTheirMargin) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "0 0 0\n0 0 8\n1 6.9 0\n0 7.1 0\n0 0 7.5\n");
  expect_glass_refused(folder, {"engrave", list, "--block", "20,20,20", "--report", folder / "r"},
                       {"3 of 5 points", "point 1 at (0, 0, 8) mm", "margin", "7"});
  const Finished narrow = run({"engrave", list, "--block", "20,20,20", "--margin", "2"});
  EXPECT_EQ(narrow.status, 0) << narrow.err;
  EXPECT_THAT(narrow.out, HasSubstr("warning  a margin of 2 mm"));
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  expect_glass_refused(
      folder, {"points", mesh, "--size", "15", "--block", "20,20,20", "-o", folder / "o.xyz"},
      {"--size 14"});
  // The object is moved out of the block.
  expect_glass_refused(folder,
                       {"points", mesh, "--size", "10", "--block", "20,20,20", "--transform",
                        "move 4 0 0", "-o", folder / "o.xyz"},
                       {"lie outside the block"});
}

TEST(Glass, ThatIsImpossible) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "0 0 0\n");
  const auto refused = [&](const std::vector<std::string>& options, const std::string& names) {
    expect_glass_refused(folder, joined({"engrave", list}, options), {names});
    expect_glass_refused(folder, joined({"frame", list}, options), {names});
  };
  refused({"--block", "20,0,20"}, "--block");
  refused({"--block", "20,20"}, "--block");
  refused({"--block", "20,20,nan"}, "--block");
  refused({"--block", "5,50,50"}, "margin");
  refused({"--index", "0.99"}, "--index");
  refused({"--index", "nan"}, "--index");
  refused({"--material", "k9", "--index", "1.5"}, "both");
  refused({"--material", "butter"}, "--material");
  refused({"--lens", "f50"}, "--lens");
  refused({"--block", "20,20,20", "--block-at", "500,0,0"}, "outside the machine's travel");
  refused({"--transform", "turn z 3"}, "--transform");
}

TEST(Glass, LensesNeedTheirSpacing) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const auto smallest = [&](const char* lens) {
    const Json made = run_json({"points", mesh, "--lens", lens, "-o", folder / "o.xyz"});
    EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
    return made["spacing"]["smallest_mm"].get<double>();
  };
  EXPECT_GE(smallest("f43"), 0.09);
  EXPECT_LT(smallest("f43"), 0.1);
  EXPECT_GE(smallest("f70"), 0.13);
  const std::string close = folder.write("p.xyz", "0 0 0\n1 0 0\n1 0.1 0\n");
  EXPECT_THAT(run({"engrave", close, "--lens", "f70"}).out, HasSubstr("points 1 and 2 are 0.1 mm"));
}

TEST(Glass, DuplicatesAreReportedAndEngraved) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "0 0 0\n1 0 0\n0 0 0\n2 0 0\n0 0 0\n");
  const Json made = run_json({"points", list, "-o", folder / "o.xyz"});
  EXPECT_EQ(made["points"], 5);
  EXPECT_EQ(made["spacing"]["duplicates"], 2);
  EXPECT_THAT(made["warnings"].dump(), HasSubstr("2 points lie exactly"));
  EXPECT_EQ(run_json({"engrave", list})["shots"], 5);
}

TEST(Pauses, CostTheirBeatsAndNoPoint) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(100, 3);
  const std::string list = folder.write("p.xyz", xyz(points));
  const auto beats = [&](const char* length) {
    const Json report = run_json({"engrave", list, "--pause-every", "30", "--pause-beats", length,
                                  "--shots", folder / "shots.csv"});
    EXPECT_EQ(report["points"], 100);
    EXPECT_EQ(report["shots"], 100);
    EXPECT_EQ(report["missed"], 0);
    EXPECT_EQ(report["doubled"], 0);
    EXPECT_EQ(read_shots(folder / "shots.csv").size(), 100u);
    return report["beats"].get<int>();
  };
  const int short_ones = beats("40");
  EXPECT_EQ(beats("240") - short_ones, 3 * 200);
  expect_glass_refused(folder, {"engrave", list, "--pause-every", "5", "--pause-beats", "0"},
                       {"--pause-beats"});
  expect_glass_refused(folder, {"engrave", list, "--pause-every", "-1"}, {"--pause-every"});
}

TEST(Pauses, AJobContinuesFromAnyPlace) {
  const Folder folder;
  const std::vector<geometry::Point> points = walk(25, 3);
  const std::string list = folder.write("p.xyz", xyz(points));
  // Targets: ten points, a pause, ten points, a pause, five points.
  for (const int from : {0, 1, 9, 10, 11, 20, 21, 22, 26}) {
    const int pauses_before = from > 21 ? 2 : from > 10 ? 1 : 0;
    const auto left = static_cast<std::size_t>(25 - (from - pauses_before));
    const Json report = run_json({"engrave", list, "--pause-every", "10", "--pause-beats", "7",
                                  "--from", std::to_string(from), "--shots", folder / "shots.csv"});
    EXPECT_EQ(report["points"], left) << from;
    EXPECT_EQ(report["missed"], 0) << from;
    EXPECT_EQ(report["doubled"], 0) << from;
    const auto shots = read_shots(folder / "shots.csv");
    ASSERT_EQ(shots.size(), left) << from;
    for (std::size_t i = 0; i < left; ++i)
      EXPECT_NEAR(shots[i].x, points[25 - left + i].x, rounded_half_step_mm) << from;
  }
}

TEST(Description, EqualsTheOptions) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::vector<std::string> options{
      "--size",        "6",           "--spacing",     "0.4",
      "--block",       "30,30,40",    "--material",    "fused-silica",
      "--transform",   "rotate z 30", "--transform",   "move 0 0 2",
      "--pause-every", "50",          "--pause-beats", "5",
      "--order",       "cone",        "--mode",        "path",
      "--lamp",        "50",          "--flashes",     "2"};
  ASSERT_EQ(
      run(joined({"job", mesh, "-o", folder / "a.llj", "--save", folder / "job.toml"}, options))
          .status,
      0);
  const Finished again = run({"job", folder / "job.toml", "-o", folder / "b.llj"});
  ASSERT_EQ(again.status, 0) << again.err << read(folder / "job.toml");
  EXPECT_EQ(read(folder / "a.llj"), read(folder / "b.llj")) << read(folder / "job.toml");
  EXPECT_EQ(run({"frame", folder / "job.toml"}).status, 0);
  EXPECT_EQ(run_json({"engrave", folder / "job.toml"})["shots"].get<int>() % 2, 0);
}

TEST(Description, IsEstimatedToTheBeat) {
  const Folder folder;
  folder.write("m.stl", octahedron_stl());
  const std::string toml = folder.write(
      "job.toml",
      "[glass]\nmaterial = \"k9\"\nblock = [30, 30, 40]\n[pause]\nevery = 60\nbeats = 30\n"
      "[[object]]\nfile = \"m.stl\"\nsize = 6\nspacing = 0.5\n");
  const Json foreseen = run_json({"estimate", toml});
  const Json report = run_json({"engrave", toml});
  for (const char* key : {"points", "shots", "beats", "beats_before", "utilisation"})
    EXPECT_EQ(foreseen[key], report[key]) << key;
}

TEST(Description, OfTheExamplesIsValid) {
  namespace fs = std::filesystem;
  const Folder folder;
  for (const char* file : {"block.toml", "badge.svg", "machine.toml"})
    fs::copy_file(fs::path(lamplock::test::in_repository("examples")) / file, folder / file);
  EXPECT_EQ(run({"example", folder / "nautilus.stl"}).status, 0);
  const Json made = run_json({"points", folder / "block.toml", "-o", folder / "o.ply"});
  EXPECT_GT(made["points"], 10000);
  EXPECT_EQ(made["warnings"], Json::array());
}

TEST(Description, RefusesOptionsThatItHasKeysFor) {
  const Folder folder;
  folder.write("p.xyz", "0 0 0\n1 0 0\n");
  const std::string toml = folder.write("job.toml", "[[object]]\nfile = \"p.xyz\"\n");
  EXPECT_EQ(run_json({"engrave", toml})["shots"], 2);
  for (const auto& option : std::vector<std::vector<std::string>>{{"--spacing", "0.3"},
                                                                  {"--lamp", "50"},
                                                                  {"--invert"},
                                                                  {"--block", "9,9,9"},
                                                                  {"--transform", "fit"},
                                                                  {"--no-end-points"}})
    expect_glass_refused(folder, joined({"engrave", toml}, option), {"job.toml"});
  folder.write("job.toml", "[[object]]\nfile = \"p.xyz\"\n\nsise = 3\n");
  expect_glass_refused(folder, {"engrave", toml}, {"job.toml:4: unknown key 'sise'"});
  folder.write("job.toml", "[[object]]\nfile = \"none.xyz\"\n");
  expect_glass_refused(folder, {"engrave", toml}, {"none.xyz"});
}

TEST(Description, SeveralObjectsInOneBlock) {
  const Folder folder;
  folder.write("m.stl", octahedron_stl());
  folder.write("d.bmp", disc_bmp(30));
  folder.write("p.xyz", "0 0 1\n0 0 1.01\n2 2 2\n");
  const std::string toml = folder.write("job.toml",
                                        "[glass]\nblock = [30, 30, 30]\nlens = \"f43\"\n"
                                        "[[object]]\nfile = \"m.stl\"\nsize = 8\nspacing = 0.5\n"
                                        "[[object]]\nfile = \"p.xyz\"\n"
                                        "[[object]]\nfile = \"d.bmp\"\nsize = 8\nspacing = 0.5\n"
                                        "transform = [\"rotate x 90\"]\n");
  const Json made = run_json({"points", toml, "-o", folder / "o.xyz"});
  EXPECT_EQ(made["kind"], "several");
  const auto cloud = model::read_point_list(folder / "o.xyz");
  // geometry::Point lists keep their points, however close; other objects keep a distance from all
  // points.
  EXPECT_EQ(cloud[0], (geometry::Point{0, 0, 1}));
  EXPECT_EQ(cloud[1], (geometry::Point{0, 0, 1.01}));
  EXPECT_EQ(cloud[2], (geometry::Point{2, 2, 2}));
  EXPECT_GT(cloud.size(), 300u);
  for (std::size_t i = 3; i < cloud.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      ASSERT_GE(
          std::hypot(cloud[i].x - cloud[k].x, cloud[i].y - cloud[k].y, cloud[i].z - cloud[k].z),
          0.45 - 1e-9);
  const Json report = run_json({"engrave", toml});
  EXPECT_EQ(report["shots"], cloud.size());
  EXPECT_EQ(report["missed"], 0);
}

class Methods : public testing::TestWithParam<const char*> {};

TEST_P(Methods, KeepTheirDistanceAndEngrave) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::vector<std::string> how{mesh, "--method",  GetParam(), "--size",
                                     "6",  "--spacing", "0.4"};
  const Json made = run_json(joined({"points", "-o", folder / "o.xyz"}, how));
  EXPECT_GT(made["points"], 200);
  EXPECT_GE(made["spacing"]["smallest_mm"].get<double>(), 0.36 - 1e-9);
  EXPECT_EQ(made["spacing"]["duplicates"], 0);
  for (const geometry::Point& p : model::read_point_list(folder / "o.xyz"))
    EXPECT_LT(std::abs(p.x) + std::abs(p.y) + std::abs(p.z), 3 + 1e-5);
  const Json report = run_json(joined({"engrave"}, how));
  EXPECT_EQ(report["shots"], made["points"]);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["doubled"], 0);
}

INSTANTIATE_TEST_SUITE_P(all, Methods,
                         testing::Values("blue-noise", "slice", "faces", "rays", "solid"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

class Orders : public testing::TestWithParam<const char*> {};

TEST_P(Orders, FireTheSamePoints) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const Json report =
      run_json({"engrave", mesh, "--size", "6", "--spacing", "0.4", "--order", GetParam()});
  EXPECT_GT(report["shots"], 200);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_EQ(report["doubled"], 0);
}

INSTANTIATE_TEST_SUITE_P(all, Orders,
                         testing::Values("given", "layers", "serpentine", "nearest", "cone",
                                         "best"),
                         [](const auto& test) { return test.param; });

TEST(Methods, OfDrawings) {
  const Folder folder;
  const std::string svg = folder.write(
      "d.svg",
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20mm\" height=\"20mm\" "
      "viewBox=\"0 0 20 20\"><circle cx=\"10\" cy=\"10\" r=\"8\"/><text>no</text></svg>");
  const Json made = run_json(
      {"points", svg, "--spacing", "0.5", "--layers", "3", "--layer", "1", "-o", folder / "o.dxf"});
  EXPECT_EQ(made["kind"], "curves");
  EXPECT_EQ(made["points"], 3 * static_cast<int>(2 * M_PI * 8 / 0.5));
  EXPECT_THAT(made["warnings"].dump(), HasSubstr("text"));
  for (const geometry::Point& p : model::read_point_list(folder / "o.dxf"))
    EXPECT_NEAR(std::hypot(p.x, p.y), 8, 1e-6);
  EXPECT_EQ(run_json({"engrave", svg, "--spacing", "0.5"})["missed"], 0);
}

/// A box with faces along the axes.
std::string box_obj() {
  return "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
         "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

TEST(Warnings, OfFacesThatSlicesMiss) {
  const Folder folder;
  const std::string box = folder.write("b.obj", box_obj());
  const auto warnings = [&](const std::vector<std::string>& options) {
    return run_json(joined({"points", box, "--size", "5", "--spacing", "0.5", "-o",
                            folder / "o.xyz", "--method", "slice"},
                           options))["warnings"]
        .dump();
  };
  // The middle of the caps, 2 mm of 5 mm square: farther from the edges than 3 spacings.
  EXPECT_THAT(warnings({}), AllOf(HasSubstr("5.9 % of the surface"), HasSubstr("1.5 mm")));
  EXPECT_EQ(warnings({"--turn", "30,30,0"}), "[]");
}

TEST(Warnings, OfMeshesWithHoles) {
  const Folder folder;
  std::string stl = octahedron_stl();
  const auto last = stl.rfind("facet normal");
  stl.erase(last, stl.find("endfacet", last) + 9 - last);
  const std::string mesh = folder.write("m.stl", stl);
  const Json made =
      run_json({"points", mesh, "--size", "5", "--spacing", "0.5", "-o", folder / "o.xyz"});
  EXPECT_THAT(made["warnings"].dump(), HasSubstr("m.stl: 3 "));
  expect_glass_refused(folder,
                       {"points", mesh, "--size", "5", "--method", "solid", "-o", folder / "p.xyz"},
                       {"open"});
}

TEST(Warnings, OfOptionsThatTheMethodIgnores) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const std::string list = folder.write("p.xyz", "0 0 0\n1 0 0\n");
  const auto warnings = [&](const std::vector<std::string>& options) {
    const Json made = run_json(joined({"points", "-o", folder / "o.xyz"}, options));
    EXPECT_EQ(made["warnings"].size(), 1u) << made["warnings"];
    return made["warnings"].dump();
  };
  EXPECT_THAT(warnings({mesh, "--turn", "10,0,0"}),
              AllOf(HasSubstr("--turn does nothing with blue-noise"), HasSubstr("slice, rays")));
  EXPECT_THAT(warnings({mesh, "--light-depth", "2", "--method", "slice"}),
              AllOf(HasSubstr("--light-depth"), HasSubstr("solid")));
  EXPECT_THAT(warnings({mesh, "--layer", "0.5"}), HasSubstr("slice, drawings, bitmaps"));
  EXPECT_THAT(warnings({mesh, "--gamma", "2"}), HasSubstr("--gamma does nothing without --tone"));
  EXPECT_THAT(warnings({list, "--size", "5"}), HasSubstr("--size does nothing with point lists"));
  EXPECT_THAT(warnings({list, "--margin", "5"}), HasSubstr("without --block"));
  const std::string toml = folder.write("t.toml",
                                        "[[object]]\nfile = \"m.stl\"\nthreshold = 90\n[order]\n"
                                        "by = \"layers\"\nlayer = 0.2\n");
  EXPECT_THAT(warnings({toml}), HasSubstr("m.stl: --threshold does nothing with blue-noise"));
  const Finished ordered = run({"order", list, "--layer", "0.2", "-o", folder / "q.xyz"});
  EXPECT_EQ(ordered.status, 0);
  EXPECT_THAT(ordered.out, HasSubstr("--layer does nothing with order best"));
}

TEST(Warnings, AreAbsentFromValidJobs) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  for (const char* method : {"blue-noise", "slice", "faces", "rays", "solid"}) {
    const Json made = run_json({"points", mesh, "--size", "5", "--spacing", "0.5", "--method",
                                method, "-o", folder / "o.xyz"});
    EXPECT_TRUE(made["warnings"].empty()) << method << made["warnings"];
  }
}

TEST(Shells, SpreadNeighboursInwards) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const Json made = run_json({"points", mesh, "--size", "6", "--spacing", "0.4", "--shells", "3",
                              "--shell", "0.2", "-o", folder / "o.xyz"});
  EXPECT_GE(made["spacing"]["smallest_mm"].get<double>(), 0.4 - 1e-9);
  std::size_t inside = 0;
  for (const geometry::Point& p : model::read_point_list(folder / "o.xyz"))
    if (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) < 3 - 0.1) ++inside;
  EXPECT_GT(inside, made["points"].get<std::size_t>() / 3);
}

TEST(Depth, ThinsPointsNearTheFace) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const auto count = [&](const std::vector<std::string>& more) {
    return run_json(joined({"points", mesh, "--size", "10", "--spacing", "0.3", "--block",
                            "20,20,20", "-o", folder / "o.xyz"},
                           more))["points"]
        .get<double>();
  };
  const double all = count({});
  // The mean depth is the middle of the block.
  EXPECT_NEAR(count({"--face-density", "0.5"}) / all, 0.75, 0.05);
}

}  // namespace
}  // namespace lamplock::cli::test
