// `lamplock jerk`: steps and points of the patent's tables, a program that `check` accepts, points
// and chart, the comparison, the learning run, one-line errors.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

constexpr const char* example_line = "61.76487 172.88918 0\n65.23753 174.61331 0\n";
constexpr const char* part_program =
    "G21 G90\nM4 S500\nG0 X10 Y10\nG1 X30 F900\nG2 X40 Y20 I0 J10\nG1 Y40\nG4 P0.2\nX20 Y45 S300\n"
    "M8\nG1 X10 Y10\nM9\nM5\nG0 X0 Y0\nM2\n";

nlohmann::json json_of(const std::vector<std::string>& arguments) {
  const Finished done = run(arguments);
  EXPECT_EQ(done.status, 0) << done.err;
  return nlohmann::json::parse(done.out);
}

TEST(Jerk, ReproducesThePatentsTables) {
  const Folder folder;
  const std::string file = folder.write("line.xyz", example_line);
  const nlohmann::json first =
      json_of({"jerk", file, "--variant", "printed", "--n", "2", "--k", "7", "--step-a", "0",
               "--step-b", "0.1", "--no-compare", "--json"})["segments"][0];
  EXPECT_EQ(first["accelerate"], 73);
  EXPECT_EQ(first["hold"], 14);
  EXPECT_NEAR(first["points"][88][0].get<double>(), 62.908336, 5e-6);
  EXPECT_NEAR(first["points"].back()[1].get<double>(), 174.61331, 1e-12);
  const nlohmann::json second =
      json_of({"jerk", file, "--variant", "printed", "--n", "14", "--k", "2", "--step-a", "1",
               "--step-b", "0", "--no-compare", "--json"})["segments"][0];
  EXPECT_EQ(second["accelerate"], 70);
  EXPECT_EQ(second["hold"], 15);
  EXPECT_NEAR(second["points"][14][1].get<double>(), 172.89002, 1e-6);
}

TEST(Jerk, WritesAProgramThatCheckAccepts) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", part_program), out = folder / "b.ngc";
  const nlohmann::json seen = json_of({"jerk", file, "-o", out, "--no-compare", "--json"});
  EXPECT_EQ(seen["segments"].size(), 7u);
  const nlohmann::json before = json_of({"check", file, "--json"}),
                       after = json_of({"check", out, "--json"});
  EXPECT_EQ(after["problems"].size(), 0u);
  EXPECT_NEAR(after["feed_mm"].get<double>(), before["feed_mm"].get<double>(), 0.01);
  EXPECT_EQ(after["rapid_mm"], before["rapid_mm"]);
  EXPECT_EQ(after["high_mm"], before["high_mm"]);
  EXPECT_GT(after["time_s"].get<double>(), before["time_s"].get<double>());
  const std::string text = read(out);
  for (const char* line :
       {"\nM4 S500.000\n", "\nG4 P0.2\n", "\nM8\n", "\nM9\n", "\nM5\n", "\nM2\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

/// A dwell has light on boards that permit it (setting 936) after M3 and G1, with its S.
TEST(Jerk, KeepsTheLightOfDwells) {
  const Folder folder;
  const std::string out = folder / "b.ngc",
                    file =
                        folder.write("a.ngc",
                                     "G21 F600 G0 X0\nM3 S200 G1\nG4 P0.3\nX10 S800\nM4\nG4 P0.2\n"
                                     "X20\nM3 G0 X30\nG4 P0.1\nG1 X40 S100\nG4 P0.4\nM2\n");
  ASSERT_EQ(run({"jerk", file, "-o", out, "--no-compare"}).status, 0);
  const std::string text = read(out);
  for (const char* part :
       {"M3 S200 G1 F1\nG4 P0.3\nM3 S800.000\nG1", "M5\nG4 P0.2\nM4 S800.000\nG1",
        "M5\nG4 P0.1\nM3 S100", "M3 S100 G1 F1\nG4 P0.4\n"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_EQ(run({"check", out}).status, 0);
}

TEST(Jerk, KeepsTheEnergyOfALaserAndTheSpeedOfASpindle) {
  const Folder folder;
  const std::string file = folder.write("a.ngc",
                                        "G21 M4 S1000\nG0 X0\nG1 X10 F600\nM3 S400 X20\nM5\nM2\n"),
                    machine = folder.write("m.toml", "laser_mode = 0\n"), out = folder / "b.ngc";
  const auto written = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"jerk", file, "-o", out, "--no-compare"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 0) << done.err;
    return lines(read(out));
  };
  // With M4 the energy per mm is the same in each piece: S over F.
  bool is_proportional = false;
  int pieces = 0;
  double s = 0;
  for (const std::string& line : written({})) {
    if (line.starts_with("M3") || line.starts_with("M4")) is_proportional = line[1] == '4';
    if (const std::size_t at = line.find('S'); at != std::string::npos)
      s = std::stod(line.substr(at + 1));
    if (!line.starts_with("G1")) continue;
    ++pieces;
    const double feed = std::stod(line.substr(line.find('F') + 1));
    if (is_proportional) {
      EXPECT_NEAR(s / feed, 1000.0 / 600, 0.001) << line;
    } else {
      EXPECT_EQ(s, 400) << line;
    }
  }
  EXPECT_GT(pieces, 50);
  for (const std::string& line : written({"--machine", machine}))
    EXPECT_TRUE(!line.starts_with("G1") || line.find('S') == std::string::npos) << line;
}

TEST(Jerk, RemarksOnCurvesThatAreNoArcs) {
  const Folder folder;
  const Finished done = run(
      {"jerk", folder.write("a.ngc", "G0 X5 Y0 F100\nG5 X10 Y5 I1 J3 P0 Q3\n"), "--no-compare"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("a.ngc:2: the curve is no arc"));
}

/// The columns of the CSV from x_mm on, without the row of names.
std::vector<std::array<double, 3>> csv_places(const std::string& text) {
  std::vector<std::array<double, 3>> places;
  std::istringstream in(text);
  std::string row, cell;
  std::getline(in, row);
  while (std::getline(in, row)) {
    std::istringstream cells(row);
    for (int i = 0; i < 4; ++i) std::getline(cells, cell, ',');
    auto& place = places.emplace_back();
    for (double& value : place) std::getline(cells, cell, ','), value = std::stod(cell);
  }
  return places;
}

TEST(Jerk, PointsKeepTheLimits) {
  const Folder folder;
  const std::string points = folder / "a.csv", chart = folder / "a.svg";
  const Finished done = run({"jerk", folder.write("a.ngc", part_program), "--points", points,
                             "--chart", chart, "--period", "1", "--max-speed", "20,15,10",
                             "--max-accel", "400", "--max-jerk", "8000,5000,1000", "--no-compare"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto at = csv_places(read(points));
  ASSERT_GT(at.size(), 1000u);
  const double speed[2] = {20, 15}, jerk[2] = {8000, 5000}, accel = 400, t = 0.001;
  double max_speed = 0, max_jerk = 0;
  for (std::size_t i = 3; i < at.size(); ++i)
    for (std::size_t a = 0; a < 2; ++a) {
      const double v = (at[i][a] - at[i - 1][a]) / t, w = (at[i - 1][a] - at[i - 2][a]) / t,
                   u = (at[i - 2][a] - at[i - 3][a]) / t;
      ASSERT_LE(std::abs(v), speed[a]) << i;
      ASSERT_LE(std::abs(v - w) / t, accel) << i;
      ASSERT_LE(std::abs(v - 2 * w + u) / (t * t), jerk[a]) << i;
      max_speed = std::max(max_speed, std::abs(v));
      max_jerk = std::max(max_jerk, std::abs(v - 2 * w + u) / (t * t));
    }
  EXPECT_GT(max_speed, 14.9);  // F900
  EXPECT_GT(max_jerk, 7000);
  EXPECT_THAT(read(chart), HasSubstr("acceleration / mm/s2"));
  EXPECT_THAT(read(chart), HasSubstr("a.ngc, strict, n=2 k=7"));
}

TEST(Jerk, ComparesWithTheFirmwareAndTheOptimum) {
  const Folder folder;
  const std::string file = folder.write("a.xyz", "0 0 0\n8 3 0\n10 9 0\n2 8 0\n");
  const nlohmann::json rows = json_of({"jerk", file, "--json"})["comparison"];
  ASSERT_EQ(rows.size(), 4u);
  const double strict = rows[2]["time_s"], optimum = rows[3]["time_s"];
  EXPECT_GT(strict, optimum);
  EXPECT_LT(strict, 3 * optimum);
  EXPECT_LE(rows[2]["max_jerk_mm_s3"], 10'000);
  EXPECT_GT(rows[1]["max_jerk_mm_s3"], 10'000);
  for (const int row : {0, 1, 2}) {
    const nlohmann::json& board = rows[static_cast<std::size_t>(row)]["board"];
    EXPECT_GT(board["time_s"], 1.0) << row;
    EXPECT_GT(board["contour_error"]["mean_mm"], 0.0) << row;
    EXPECT_LT(board["contour_error"]["max_mm"], 0.5) << row;
  }
}

TEST(Jerk, PlansProgramsWithZ) {
  const Folder folder;
  const nlohmann::json seen = json_of(
      {"jerk", folder.write("a.ngc", "G0 X0 Y0 Z0\nG18 G1 X5 F600\nG2 X10 Z5 I0 K5\nG1 Y3\n"),
       "--json"});
  EXPECT_EQ(seen["segments"].size(), 3u);
  const nlohmann::json& rows = seen["comparison"];
  EXPECT_TRUE(rows[0]["board"].is_null());
  EXPECT_GT(rows[0]["time_s"], 1.5);
  EXPECT_GT(rows[2]["time_s"], rows[3]["time_s"]);
}

TEST(Jerk, LearnsALawForEachBlock) {
  const Folder folder;
  const std::string file = folder.write("a.xyz", "0 0 0\n4 3 0\n5 8 0\n");
  const nlohmann::json seen = json_of({"jerk", file, "--learn", "--no-compare", "--json"});
  const nlohmann::json& learned = seen["learned"];
  EXPECT_EQ(learned["candidates"][0]["step_a"], 0.05);
  EXPECT_GE(learned["candidates"].size(), 10u);
  const nlohmann::json &before = learned["candidates"][0]["contour_error"],
                       &after = learned["contour_error"];
  EXPECT_EQ(learned["mean_falls"], after["mean_mm"] < before["mean_mm"]);
  EXPECT_EQ(learned["std_falls"], after["std_mm"] < before["std_mm"]);
  EXPECT_TRUE(learned["mean_falls"].get<bool>() || learned["std_falls"].get<bool>());
  EXPECT_EQ(seen["segments"].size(), 2u);
}

TEST(Jerk, RefusesWhatItCannotOptimise) {
  const Folder folder;
  const std::string line = folder.write("line.xyz", example_line);
  const auto refused = [](std::vector<std::string> arguments, const char* what) {
    arguments.insert(arguments.begin(), "jerk");
    arguments.emplace_back("--no-compare");
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 2) << what;
    EXPECT_THAT(done.err, HasSubstr(what));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  };
  refused({line, "--n", "1e10", "--k", "100"}, "n^k is too large");
  refused({line, "--max-speed", "0"}, "--max-speed");
  refused({line, "--max-jerk", "10,-1,3"}, "--max-jerk");
  refused({line, "--max-accel", "1,2"}, "--max-accel: has two numbers");
  refused({line, "--time-constant", "1e6"}, "--time-constant");
  refused({line, "--damping", "1e9"}, "--damping");
  refused({line, "--period", "500", "--max-jerk", "1e9", "--max-accel", "1e9"},
          "less than the control period");
  refused({folder.write("a.ngc", "G0 X2 Y0 Z0 F100\nG2 X3 Y1 Z2 A1 I1\n")}, "a.ngc:2");
  refused({folder.write("b.ngc", "G0 X2 F100\nM130 P0\nG1 X3\n")}, "b.ngc:2: points on the beat");
  refused({folder.write("c.ngc", "G21\n")}, "no block");
  refused({folder.write("d.xyz", "1 1 1\n")}, "no block");
  const std::string out = folder / "out.ngc";
  refused({line, "-o", out, "--chart", folder / "a.png"}, "a.png");
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// The machine may be anywhere at the start.
TEST(Jerk, KeepsTheApproach) {
  const Folder folder;
  const std::string out = folder / "b.ngc";
  const auto begin_of = [&](const std::string& file) {
    EXPECT_EQ(run({"jerk", file, "-o", out, "--no-compare"}).status, 0);
    const std::string text = read(out);
    return text.substr(0, text.find("\nG1"));
  };
  const auto program = [&](const std::string& text) {
    return begin_of(folder.write("a.ngc", text + "M3 S500\nG1 X10 F600\n"));
  };
  const std::string head = "G21 G90 G94 G17\n", light = "M3 S500.000";
  EXPECT_EQ(program("G0 X0 Y0\n"), head + "G0 X0.00000 Y0.00000\n" + light);
  EXPECT_EQ(program("G0 Z5\nG0 X0 Y0\n"),
            head + "G0 Z5.00000\nG0 X0.00000 Y0.00000 Z5.00000\n" + light);
  EXPECT_EQ(program("G0 X3\nG0 X6 Y0\n"), head + "G0 X3.00000\nG0 X6.00000 Y0.00000\n" + light)
      << "no line from where the machine is";
  EXPECT_EQ(program("G20 G0 X1\nG91 X1\nG90 G21\n"), head + "G0 X50.80000\n" + light);
  EXPECT_EQ(begin_of(folder.write("a.xyz", "0 0 0\n5 0 0\n")), head + "G0 X0.00000 Y0.00000");
  EXPECT_EQ(begin_of(folder.write("b.xyz", "0 0 0\n5 0 1\n")),
            head + "G0 X0.00000 Y0.00000 Z0.00000");
}

TEST(Jerk, RefusesProgramsThatBeginWhereTheMachineIs) {
  const Folder folder;
  const std::string out = folder / "b.ngc";
  const auto refused = [&](const std::string& text) {
    const Finished done = run({"jerk", folder.write("a.ngc", text), "-o", out, "--no-compare"});
    EXPECT_EQ(done.status, 2) << text;
    EXPECT_FALSE(std::filesystem::exists(out));
    return done.err;
  };
  EXPECT_THAT(refused("G91 F600\nM3 S500\nG1 X10\nG1 Y10\n"), HasSubstr("a.ngc:3: the move"));
  EXPECT_THAT(refused("G0 X0\nG1 X10 F600\nG1 Y10\n"), HasSubstr("a.ngc:3: the move"));
  EXPECT_THAT(refused("G0 X0\nG1 X10 F600\nG1 Y10\n"), HasSubstr("along Y yet; begin"));
  EXPECT_THAT(refused("G91 G0 X5\nG90 G1 X10 F600\n"), HasSubstr("a.ngc:1: the move"));
  EXPECT_THAT(refused("G0 X0 Y0\nG1 Z-1 F60\nG1 X10\n"), HasSubstr("a.ngc:2: the move"));
  EXPECT_THAT(refused("G0 X5\nF600 G2 X10 I2.5\n"), HasSubstr("where the machine is"));
  EXPECT_THAT(refused("G0 X0 Y0\nG81 Z-1 R1 F60\nG80 G1 X10\n"), HasSubstr("where the machine is"));
}

/// The way of a control period may be longer than a chord of 0.002 mm deviation.
TEST(Jerk, PiecesStayOnTheirArcInEachPeriod) {
  const Folder folder;
  const std::string out = folder / "b.ngc";
  for (const auto& [radius, period_ms] : {std::pair{20.0, 10}, {2.0, 50}, {50.0, 1}}) {
    const std::string file =
        folder.write("a.ngc", fmt::format("G0 X0 Y0\nG2 X{:g} I{:g} F30000\n", 2 * radius, radius));
    ASSERT_EQ(run({"jerk", file, "-o", out, "--no-compare", "--period", std::to_string(period_ms),
                   "--max-speed", "1000", "--max-accel", "5000", "--max-jerk", "500000",
                   "--piece-time", "100"})
                  .status,
              0);
    double x = 0, y = 0, largest = 0;
    for (const std::string& line : lines(read(out))) {
      double to_x = 0, to_y = 0;
      if (std::sscanf(line.c_str(), "G1 X%lf Y%lf", &to_x, &to_y) != 2) continue;
      const double middle = std::hypot((x + to_x) / 2 - radius, (y + to_y) / 2);
      largest = std::max(largest, radius - middle);
      x = to_x, y = to_y;
    }
    EXPECT_GT(largest, 0.0005) << radius;
    EXPECT_LT(largest, 0.00202) << radius;
  }
}

TEST(Jerk, RefusesProgramsWhosePlacesDependOnTheBoard) {
  const Folder folder;
  for (const char* word : {"G55", "G59.3", "G53 G1 X5", "G10 L2 P1 X10", "G92 X5", "G92.3",
                           "G28 X0", "G30.1", "g5 5 G1 X1", "$H"}) {
    const Finished done =
        run({"jerk", folder.write("a.ngc", fmt::format("G1 X1 F600\n{}\nG1 X3\n", word))});
    EXPECT_EQ(done.status, 2) << word;
    EXPECT_THAT(done.err, HasSubstr("a.ngc:2: ")) << word;
  }
  EXPECT_EQ(
      run({"jerk", folder.write("b.ngc", "G54 (G55)\nG0 X0\nG1 X1 F600\n"), "--no-compare"}).status,
      0);
}

TEST(Jerk, TakesTheMachineIntoAccount) {
  const Folder folder;
  const std::string machine =
      folder.write("m.toml",
                   "axes = 3\nmax_rate = [6000, 6000, 6000]\nacceleration = [1000, 1000, 1000]\n"
                   "jerk = [10, 10, 10]\ntravel = [50, 50, 50]\nmin_corner = [0, 0, 0]\n");
  const std::string part = folder.write("a.ngc", part_program), out = folder / "b.ngc";
  const Finished done =
      run({"jerk", part, "--machine", machine, "--no-compare", "--json", "-o", out});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("$1081 to $1083"));
  const nlohmann::json times = nlohmann::json::parse(done.out)["machine"];
  const double checked = json_of({"check", out, "--machine", machine, "--json"})["time_s"];
  EXPECT_NEAR(times["time_s"].get<double>(), checked, 0.02 * checked);
  const Finished outside = run({"jerk", folder.write("c.ngc", "G1 X10 F600\nX60\n"), "--machine",
                                machine, "--no-compare", "-o", folder / "d.ngc"});
  EXPECT_EQ(outside.status, 2);
  EXPECT_THAT(outside.err, HasSubstr("c.ngc:2: X 60.000 mm is outside"));
  EXPECT_FALSE(std::filesystem::exists(folder / "d.ngc"));
}

TEST(Jerk, AComparisonThatIsNotPossibleKeepsNoResultBack) {
  const Folder folder;
  const std::string out = folder / "b.ngc";
  const Finished done =
      run({"jerk", folder.write("a.ngc", part_program), "--max-jerk", "1", "-o", out});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("no comparison: "));
  EXPECT_TRUE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace lamplock::cli::test
