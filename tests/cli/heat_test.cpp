// `lamplock heat`: the half space, files, a program with a dense hatch, a held temperature, the
// controller, one-line errors.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// The constants of the half space for which the exact solution is known.
constexpr const char* acrylic_record =
    "[[material]]\nname = \"acrylic\"\ndensity_g_cm3 = 1.18\nabsorption = 1\n"
    "conductivity_w_mk = 0.19\nspecific_heat_j_gk = 1.466\n";
constexpr const char* hatch_program =
    "G21 G90\nM4 S1000\nG1 X3 F600\nG1 Y0.2\nG1 X1\nG1 Y0.4\nG1 X2\nM5\nM2\n";

nlohmann::json heat_json(const std::vector<std::string>& arguments) {
  const Finished done = run(arguments);
  EXPECT_EQ(done.status, 0) << done.err;
  return done.status == 0 ? nlohmann::json::parse(done.out) : nlohmann::json();
}

TEST(Heat, HalfSpaceWithItsFiles) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record);
  const std::string csv = folder / "a.csv", picture = folder / "a.svg";
  const nlohmann::json heat =
      heat_json({"heat", "--materials", records, "--flux", "1e4", "--losses", "none", "--thickness",
                 "4", "--csv", csv, "--picture", picture, "--json"});
  EXPECT_NEAR(heat["surface_k"][19].get<double>() - 293.15, 19.682, 0.003 * 19.682);
  EXPECT_NEAR(heat["surface_k"][99].get<double>() - 293.15, 44.010, 0.003 * 44.010);
  EXPECT_LT(heat["balance"]["relative_error"].get<double>(), 1e-9);
  EXPECT_EQ(lines(read(csv)).size(), 1u + 100 * 50);
  EXPECT_THAT(read(csv), StartsWith("time_s,node,depth_mm,temperature_k,rate_k_s\n"));
  EXPECT_THAT(read(picture), HasSubstr("</svg>"));
}

TEST(Heat, ProgramWithAHatch) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record),
                    program = folder.write("a.ngc", hatch_program), csv = folder / "a.csv",
                    picture = folder / "a.svg";
  const Finished done = run({"heat", program, "--materials", records, "--power", "0.1", "--beam",
                             "0.4", "--no-check", "--csv", csv, "--picture", picture, "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  const nlohmann::json heat = nlohmann::json::parse(done.out);
  EXPECT_EQ(heat["lines"].size(), 5u);
  EXPECT_LT(heat["balance"]["relative_error"].get<double>(), 1e-9);
  EXPECT_GT(heat["lines"][4]["max_k"].get<double>(), heat["lines"][0]["max_k"].get<double>());
  EXPECT_GT(lines(read(csv)).size(), 100u);
  EXPECT_THAT(read(picture), HasSubstr("</svg>"));
}

TEST(Heat, HoldsAndTunes) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record);
  const nlohmann::json held =
      heat_json({"heat", "--hold", "450K", "--feeds", "600", "--materials", records, "--power", "3",
                 "--beam", "0.4", "--no-check", "--json"});
  EXPECT_NEAR(held["pairs"][0]["temperature_k"].get<double>(), 450, 0.5);
  const nlohmann::json tuned =
      heat_json({"heat", "--tune", "--gain", "450", "--time-constant", "0.2", "--json"});
  EXPECT_NEAR(tuned["set_point_step"]["settling_s"].get<double>(), 0.05, 5e-4);
  EXPECT_NEAR(tuned["set_point_step"]["overshoot"].get<double>(), 0.028, 5e-4);
  EXPECT_NEAR(tuned["zeta"].get<double>(), 0.7512, 1e-4);
}

/// Light at rest has the power and the time that the machine permits, and belongs to its line.
TEST(Heat, ComputesLightInDwells) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record),
                    program = folder.write(
                        "a.ngc", "G21 G90 F600\nM3 S500 G1\nG4 P3\nX1 S50\nM4\nG4 P1\nM2\n");
  const auto heated = [&](const char* settings) {
    return heat_json({"heat", program, "--materials", records, "--power", "1", "--beam", "0.4",
                      "--no-check", "--json", "--machine", folder.write("m.toml", settings)});
  };
  const auto rise = [](const nlohmann::json& line) { return line["max_k"].get<double>() - 293.15; };
  const std::string laser = "laser_mode = 1\nmax_spindle_speed = 1000\n";
  const auto dark = heated(laser.c_str());
  ASSERT_EQ(dark["lines"].size(), 1u);
  EXPECT_EQ(dark["lines"][0]["line"], 4);
  const auto lit = heated((laser + "focus_power = 100\nfocus_time = 5\n").c_str());
  ASSERT_EQ(lit["lines"].size(), 2u);
  EXPECT_EQ(lit["lines"][0]["line"], 3);
  const auto weak = heated((laser + "focus_power = 25\nfocus_time = 5\n").c_str());
  EXPECT_NEAR(rise(weak["lines"][0]), rise(lit["lines"][0]) / 2, 1e-6 * rise(lit["lines"][0]));
  const auto brief = heated((laser + "focus_power = 100\nfocus_time = 0.1\n").c_str());
  EXPECT_LT(rise(brief["lines"][0]), 0.9 * rise(lit["lines"][0]));
}

TEST(Heat, RefusesInOneLine) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record),
                    dark = folder.write("dark.ngc", "G1 X1 F60\nM2\n"), out = folder / "out.csv";
  const auto refusal = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"heat", "--csv", out});
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 2) << done.out;
    EXPECT_EQ(lines(done.err).size(), 1u) << done.err;
    EXPECT_FALSE(std::filesystem::exists(out));
    return done.err;
  };
  EXPECT_THAT(refusal({"--material", "plywood", "--flux", "1e4", "--library", folder / "none.db"}),
              HasSubstr("material plywood: it has no conductivity_w_mk"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1e4", "--losses", "radiation"}),
              HasSubstr("it has no emissivity"));
  EXPECT_THAT(refusal({"--materials", records}), HasSubstr("power and beam are not given"));
  EXPECT_THAT(refusal({dark, "--materials", records, "--power", "1", "--beam", "0.4"}),
              HasSubstr("no move has the laser on"));
  EXPECT_THAT(refusal({"--hold", "warm", "--materials", records, "--power", "1", "--beam", "0.4"}),
              HasSubstr("'warm' is not a temperature"));
  EXPECT_THAT(refusal({"--hold", "250K", "--materials", records, "--power", "1", "--beam", "0.4"}),
              HasSubstr("not above the ambient temperature"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1", "--time", "1", "--step", "2"}),
              HasSubstr("longer than the time"));
  EXPECT_THAT(refusal({"--tune", "--hold", "450K"}), HasSubstr("several tasks"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1", "--feed", "60"}),
              HasSubstr("--feed: is only for a beam"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1", "--limit", "400"}),
              HasSubstr("--limit: is only for programs"));
  EXPECT_THAT(refusal({"--tune", "--gain", "100", "--time-constant", "0.1", "--material", "steel"}),
              HasSubstr("--material: is only for a process without --gain"));
  EXPECT_THAT(refusal({"--tune", "--gain", "100", "--time-constant", "0.1", "--ambient", "300"}),
              HasSubstr("--ambient: is only for a process without --gain"));
  EXPECT_THAT(refusal({"--tune", "--gain", "100", "--time-constant", "0.1", "--nodes", "30"}),
              HasSubstr("--nodes: is only for temperatures in depth"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1", "--settling", "0.1"}),
              HasSubstr("--settling: is only for --tune"));
  EXPECT_THAT(refusal({"--materials", records, "--hold", "450K", "--power", "1", "--beam", "0.4",
                       "--feed", "60", "--feeds", "60,120"}),
              HasSubstr("--feed: is only for runs without --feeds"));
  EXPECT_THAT(refusal({"--materials", records, "--flux", "1", "--machine", records}),
              HasSubstr("--machine: is only for programs"));
  EXPECT_THAT(
      refusal({dark, "--materials", records, "--power", "1", "--beam", "0.4", "--limit", "290"}),
      HasSubstr("--limit: 290 K is not above the ambient"));
  EXPECT_THAT(refusal({"--materials", folder.write("bare.toml", "[[material]]\nname = \"bare\"\n"),
                       "--flux", "1"}),
              HasSubstr("conductivity_w_mk = VALUE to its record in "));
}

TEST(Heat, NodesRefineTheMesh) {
  const Folder folder;
  const std::string records = folder.write("acrylic.toml", acrylic_record);
  for (const char* nodes : {"3", "20", "1000", "4000"}) {
    const Finished done = run({"heat", "--materials", records, "--flux", "1e4", "--time", "1",
                               "--nodes", nodes, "--losses", "none", "--json", "--no-check"});
    ASSERT_EQ(done.status, 0) << nodes << done.err;
    const auto heat = nlohmann::json::parse(done.out);
    EXPECT_LE(heat["balance"]["relative_error"].get<double>(), 1e-9) << nodes;
    const auto depths = heat["depths_mm"].get<std::vector<double>>();
    const double first = depths[1] - depths[0], last = depths.back() - depths[depths.size() - 2];
    EXPECT_LE(last / first, 4.2) << nodes;
  }
}

TEST(Heat, TunesNoLoopThatOscillatesOnTheBoard) {
  const std::vector<std::string> process{"heat", "--tune", "--gain", "300", "--sensor-volts", "2"};
  const auto tuned = [&](std::vector<std::string> more) {
    more.insert(more.begin(), process.begin(), process.end());
    return run(more);
  };
  const Finished calm = tuned({"--time-constant", "0.05", "--sensor-scale", "200"});
  EXPECT_EQ(calm.status, 0) << calm.err;
  EXPECT_THAT(calm.out, HasSubstr("$1062=2000 $1063=1.235 $1064=65.354 $1067=200 $1061=1"));
  const auto refused = [&](std::vector<std::string> more, const char* what) {
    const Finished done = tuned(std::move(more));
    EXPECT_EQ(done.status, 2) << what;
    EXPECT_THAT(done.err, HasSubstr(what));
    EXPECT_EQ(done.out, "");
  };
  for (const char* constant : {"0.05", "0.12", "0.31", "0.9"}) {
    const std::string error =
        tuned({"--time-constant", constant, "--sensor-scale", "200", "--settling", "0.015"}).err;
    const std::string remedy = "give at least ";
    const std::size_t at = error.find(remedy);
    ASSERT_NE(at, std::string::npos) << error;
    std::istringstream number(error.substr(at + remedy.size()));
    std::string seconds;
    number >> seconds;
    const Finished done =
        tuned({"--time-constant", constant, "--sensor-scale", "200", "--settling", seconds});
    EXPECT_EQ(done.status, 0) << done.err;
  }
  refused({"--time-constant", "0.005", "--sensor-scale", "200", "--settling", "0.01"},
          "too fast for the board");
  EXPECT_THAT(
      run({"heat", "--tune", "--gain", "300", "--time-constant", "0.05", "--sensor-volts", "0"})
          .err,
      HasSubstr("more than 0"));
  refused({"--time-constant", "0.05", "--sensor-scale", "0"}, "sensor_scale would be 0");
  refused({"--time-constant", "0.05", "--sensor-scale", "0.0001"}, "below its resolution");
}

}  // namespace
}  // namespace lamplock::cli::test
