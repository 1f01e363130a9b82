#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "host/error.hpp"
#include "host/report/files.hpp"
#include "host/report/picture.hpp"
#include "host/report/report.hpp"
#include "tests/report/job_run.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::report {
namespace {

namespace fs = std::filesystem;
using test::perfect_run;

class ReportFiles : public ::testing::Test {
 protected:
  static std::string read(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  lamplock::test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.file("report");
};

TEST_F(ReportFiles, JsonHasExactlyTheDocumentedKeys) {
  JobRun run = perfect_run(50, 1);
  run.beats_by_reason = {{"dropout", 3}, {"travel", 12}};
  run.beats_outside = {{"warm_up", 7}};
  run.checks = {48, 2, 1};
  run.link = {.resent = 1, .bad = 2, .reconnects = 3};
  run.settings.set_milli(settings::Id::acceleration_x, 2'000'500);
  const auto json = nlohmann::json::parse(to_json(evaluate(run)));
  std::set<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.insert(key);
  const std::set<std::string> promised{"version",
                                       "input",
                                       "mode",
                                       "board",
                                       "command",
                                       "dry",
                                       "size_mm",
                                       "spacing_mm",
                                       "method",
                                       "order",
                                       "material",
                                       "lamp_hz",
                                       "flashes_per_point",
                                       "pauses",
                                       "pause_beats",
                                       "from",
                                       "points_before",
                                       "end",
                                       "first_unfired",
                                       "may_have_fired",
                                       "continue_with",
                                       "points",
                                       "points_fired",
                                       "shots",
                                       "beats",
                                       "beats_before",
                                       "beats_per_point",
                                       "utilisation",
                                       "time_s",
                                       "points_per_s",
                                       "largest_error_steps",
                                       "largest_jitter_error_steps",
                                       "missed",
                                       "doubled",
                                       "beats_by_reason",
                                       "beats_outside",
                                       "photosensors",
                                       "link",
                                       "settings"};
  EXPECT_EQ(keys, promised);
  EXPECT_EQ(json["points"], 50);
  EXPECT_EQ(json["beats_before"], 10);
  EXPECT_EQ(json["utilisation"], 1.0);
  EXPECT_EQ(json["beats_by_reason"]["travel"], 12);
  EXPECT_EQ(json["beats_outside"]["warm_up"], 7);
  EXPECT_EQ(json["photosensors"]["not_made"], 2);
  EXPECT_EQ(json["photosensors"]["repeats"], 1);
  EXPECT_EQ(json["link"]["resent"], 1);
  EXPECT_EQ(json["link"]["bad"], 2);
  EXPECT_EQ(json["link"]["reconnects"], 3);
  EXPECT_EQ(json["settings"].size(), settings::setting_count);
  EXPECT_EQ(json["settings"]["acceleration_x"], 2000.5);
  EXPECT_EQ(json["settings"]["axes"], 3);
}

TEST_F(ReportFiles, UnknownIsNull) {
  JobRun run = perfect_run(5, 1);
  run.shots_known = false;
  run.shots.clear();
  run.lattice_steps.clear();
  const Report report = evaluate(run);
  const auto json = nlohmann::json::parse(to_json(report));
  for (const char* key : {"missed", "doubled", "largest_error_steps", "largest_jitter_error_steps"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  write_report(report, run, folder_);
  EXPECT_TRUE(fs::exists(folder_ / "report.json"));
  EXPECT_TRUE(fs::exists(folder_ / "cloud.png"));
  EXPECT_FALSE(fs::exists(folder_ / "shots.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "shots.ply"));
}

TEST_F(ReportFiles, TheDescriptionOfTheJobIsInTheFolderIfItIsKnown) {
  JobRun run = perfect_run(5, 1);
  write_report(evaluate(run), run, folder_);
  EXPECT_FALSE(fs::exists(folder_ / "job.toml"));
  run.making = {
      "lamplock engrave a.stl", "[[object]]\nfile = \"a.stl\"\n", 0.25, "slice", "best", ""};
  const Report report = evaluate(run);
  write_report(report, run, folder_);
  EXPECT_EQ(read(folder_ / "job.toml"), run.making.description);
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["command"], run.making.command);
  EXPECT_EQ(json["spacing_mm"], 0.25);
  EXPECT_EQ(json["method"], "slice");
  EXPECT_TRUE(json["material"].is_null());
  ASSERT_EQ(json["size_mm"].size(), 3u);
  double low = run.points[0].y, high = low;
  for (const geometry::Point& p : run.points) low = std::min(low, p.y), high = std::max(high, p.y);
  EXPECT_DOUBLE_EQ(json["size_mm"][1].get<double>(), high - low);
}

TEST_F(ReportFiles, ANameThatIsInvalidUtf8IsAccepted) {
  JobRun run = perfect_run(5, 1);
  run.input = "caf\xe9.stl";
  const auto input = nlohmann::json::parse(to_json(evaluate(run))).at("input").get<std::string>();
  EXPECT_EQ(input.substr(0, 3), "caf");
}

TEST_F(ReportFiles, CsvReadsBackExactly) {
  JobRun run = perfect_run(300, 5);
  run.steps_per_mm = {200, 6400, 1 / 0.00015625, 1};
  run.shots[7].channel = 3;
  run.shots[8].steps = {-1, -123'456, 7, 0};
  write_report(evaluate(run), run, folder_);
  std::ifstream in(folder_ / "shots.csv");
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "index,channel,beat,time_us,x_mm,y_mm,z_mm,point");
  for (const sim::Shot& shot : run.shots) {
    ASSERT_TRUE(std::getline(in, line));
    std::stringstream cells(line);
    std::vector<std::string> cell;
    for (std::string text; std::getline(cells, text, ',');) cell.push_back(text);
    ASSERT_EQ(cell.size(), 8u);
    EXPECT_EQ(std::stoul(cell[0]), shot.index);
    EXPECT_EQ(std::stoi(cell[1]), shot.channel);
    EXPECT_EQ(std::stoll(cell[2]), shot.beat);
    const std::size_t dot = cell[3].find('.');
    ASSERT_EQ(cell[3].size() - dot, 7u);
    EXPECT_EQ(
        std::stoll(cell[3].substr(0, dot)) * sim::ps_per_us + std::stoll(cell[3].substr(dot + 1)),
        shot.at);
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(std::stod(cell[4 + axis]), shot.steps[axis] / run.steps_per_mm[axis]);
  }
  EXPECT_FALSE(std::getline(in, line));
}

TEST_F(ReportFiles, CsvNamesThePointOfEachShot) {
  JobRun run = test::job(30, 5);
  run.first_number = 40;
  run.pauses = {10};
  std::vector<std::size_t> order{0, 1, 2, 4, 5, 3};  // one of them is late
  for (std::size_t i = 6; i < 30; ++i) order.push_back(i);
  for (const std::size_t point : order) test::add_shot_at_point(run, point);
  write_report(evaluate(run), run, folder_);
  std::istringstream in(read(folder_ / "shots.csv"));
  std::string line;
  std::getline(in, line);
  for (const std::size_t point : order) {
    ASSERT_TRUE(std::getline(in, line));
    // After the pause, numbers are one higher.
    EXPECT_EQ(std::stoul(line.substr(line.rfind(',') + 1)), 40 + point + (point >= 10 ? 1 : 0));
  }
}

TEST_F(ReportFiles, PlyContainsEveryShot) {
  JobRun run = perfect_run(200, 6);
  run.shots[3].channel = 2;
  write_report(evaluate(run), run, folder_);
  const std::string ply = read(folder_ / "shots.ply");
  const std::string end = "end_header\n";
  const std::size_t body = ply.find(end) + end.size();
  EXPECT_EQ(ply.substr(0, 4), "ply\n");
  EXPECT_NE(ply.find("format binary_little_endian 1.0\n"), std::string::npos);
  EXPECT_NE(ply.find("element vertex 200\n"), std::string::npos);
  constexpr std::size_t record = 17;
  ASSERT_EQ(ply.size() - body, 200 * record);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(ply[at + i])) << (8 * i);
    return value;
  };
  for (std::size_t i = 0; i < run.shots.size(); ++i) {
    const sim::Shot& shot = run.shots[i];
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_EQ(std::bit_cast<float>(word(body + i * record + 4 * axis)),
                static_cast<float>(shot.steps[axis] / run.steps_per_mm[axis]));
    ASSERT_EQ(word(body + i * record + 12), static_cast<std::uint32_t>(shot.beat));
    ASSERT_EQ(ply[body + i * record + 16], static_cast<char>(shot.channel));
  }
}

TEST_F(ReportFiles, AFolderThatCannotBeCreatedIsAnErrorOfOneLine) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "file") << "in the way";
  const JobRun run = perfect_run(5, 1);
  try {
    write_report(evaluate(run), run, folder_ / "file" / "report");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 7), "error: ");
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
  fs::create_directories(folder_ / "taken" / "shots.csv");
  EXPECT_THROW(write_report(evaluate(run), run, folder_ / "taken"), Error);
}

/// A decoded picture, 8 bits a channel.
struct Pixels {
  explicit Pixels(const fs::path& path) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&png, path.c_str()), 0);
    png.format = PNG_FORMAT_GRAY;
    width = png.width;
    height = png.height;
    bytes.resize(PNG_IMAGE_SIZE(png));
    EXPECT_NE(png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr), 0);
  }
  /// Pixels at least as bright as `level`.
  std::size_t brighter(int level) const {
    return static_cast<std::size_t>(
        std::count_if(bytes.begin(), bytes.end(), [level](int b) { return b >= level; }));
  }
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;
};

geometry::PointCloud sphere(int count) {
  std::mt19937_64 random(1);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  geometry::PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 2 * uniform() - 1, a = 6.283185307179586 * uniform();
    const double r = std::sqrt(1 - z * z);
    cloud.push_back({20 * r * std::cos(a) + 1000, 20 * r * std::sin(a) - 500, 20 * z});
  }
  return cloud;
}

TEST_F(ReportFiles, PictureShowsFewAndManyPoints) {
  fs::create_directories(folder_);
  const PictureSize small{.width = 400, .height = 300};
  write_cloud_picture(folder_ / "none.png", {}, small);
  const Pixels none(folder_ / "none.png");
  EXPECT_EQ(none.width, 400u);
  EXPECT_EQ(none.height, 300u);
  for (int count : {300, 3'000, 300'000}) {
    write_cloud_picture(folder_ / "some.png", sphere(count), small);
    const Pixels some(folder_ / "some.png");
    // Bright enough to be visible, but not a white patch.
    EXPECT_GT(some.brighter(180), none.brighter(180) + 200) << count;
    EXPECT_LT(some.brighter(250), some.bytes.size() / 50) << count;
  }
}

TEST_F(ReportFiles, PicturePaintsPointsThatWereNotFiredGrey) {
  fs::create_directories(folder_);
  const PictureSize small{.width = 400, .height = 300};
  const auto fired = sphere(1000);
  auto not_fired = fired;
  for (geometry::Point& p : not_fired) p = {p.x / 2 + 500, p.y / 2 - 250, p.z / 2};
  write_cloud_picture(folder_ / "fired.png", fired, small);
  write_cloud_picture(folder_ / "both.png", fired, not_fired, small);
  const Pixels all(folder_ / "fired.png"), both(folder_ / "both.png");
  constexpr int grey_low = 70, grey_high = 120;  // brighter than the glass, darker than light
  int greyed = 0, others = 0;
  for (std::size_t i = 0; i < all.bytes.size(); ++i) {
    if (all.bytes[i] == both.bytes[i]) continue;
    const bool is_grey = both.bytes[i] >= grey_low && both.bytes[i] <= grey_high;
    ++(is_grey && all.bytes[i] < both.bytes[i] ? greyed : others);
  }
  EXPECT_GT(greyed, 300);
  EXPECT_LT(others, greyed / 10);
}

TEST_F(ReportFiles, PictureAcceptsAnyCloud) {
  fs::create_directories(folder_);
  const PictureSize small{.width = 80, .height = 60};
  const double nan = std::nan("");
  for (const geometry::PointCloud& cloud :
       {geometry::PointCloud{{1, 2, 3}}, geometry::PointCloud{{1, 2, 3}, {1, 2, 3}},
        geometry::PointCloud{{nan, 0, 0}, {0, HUGE_VAL, 0}},
        geometry::PointCloud{{0, 0, -1}, {0, 0, 1}},
        geometry::PointCloud{{-1e6, 0, 0}, {1e6, 1e-6, 0}}})
    EXPECT_NO_THROW(write_cloud_picture(folder_ / "any.png", cloud, small));
  EXPECT_THROW(write_cloud_picture(folder_ / "no" / "such.png", {}, small), Error);
}

}  // namespace
}  // namespace lamplock::report
