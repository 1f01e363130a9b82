// Pictures to rows: every pixel once, at its place and feed; errors; the same rows as G-code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "host/program/program_run.hpp"
#include "host/raster/pixels.hpp"
#include "host/raster/row_gcode.hpp"
#include "host/raster/row_motion.hpp"
#include "host/raster/rows.hpp"
#include "tests/error_of.hpp"
#include "tests/job/burnt.hpp"
#include "tests/job/random_pixels.hpp"
#include "tests/scale.hpp"

namespace lamplock::raster {
namespace {

using settings::Id;
using test::Burnt;
using test::random_pixels;
using testing::HasSubstr;

/// A laser with 200 x 100 mm, 200 and 160 steps/mm, 2 m/s2, 400 mm/s.
job::Profile laser() {
  job::Profile profile;
  const auto set = [&profile](Id id, double value) {
    job::state_setting(profile, id, value, "test");
  };
  job::set_acceleration(profile, 2);
  job::set_speed(profile, 0.4);
  set(Id::steps_per_mm_y, 160);
  set(Id::travel_x, 200);
  set(Id::min_corner_x, -100);
  set(Id::laser_mode, 1);
  return profile;
}

RowOptions fast_rows(const job::Profile& profile, double feed_mm_min = 6000) {
  RowOptions options;
  options.feed_mm_min = feed_mm_min;
  options.overscan_mm = run_up_mm(profile.settings, feed_mm_min);
  return options;
}

TEST(Rows, EveryPixelIsBurntOnceAtItsPlaceAndFeed) {
  std::mt19937_64 random(1);
  const job::Profile profile = laser();
  for (int i = 0; i < test::scaled(150); ++i) {
    const Pixels pixels =
        random_pixels(1 + random() % 400, 1 + random() % 20, random, random() % 2 == 0 ? 1 : 40);
    RowOptions options = fast_rows(profile, 600 + static_cast<double>(random() % 10'000));
    const bool whole_steps = random() % 2 == 0;
    options.pitch_mm = whole_steps ? 0.005 * static_cast<double>(2 + random() % 40)
                                   : 0.0063 + 1e-5 * static_cast<double>(random() % 20'000);
    options.corner = {-60 + 0.005 * static_cast<double>(random() % 6000), 0.1, 3};
    options.one_way = random() % 3 == 0;
    const job::Job job = make_rows(pixels, options, profile);
    SCOPED_TRACE(testing::Message() << "picture " << i);
    const Burnt burnt(job, pixels, options);
    burnt.expect_each_once();
    EXPECT_LE(burnt.max_shift, whole_steps ? 1e-6 : 0.5 + 1e-6);
    ASSERT_EQ(job.size(), job.header.points_total);
    for (const job::Line& line : job.rows.lines) {
      if (line.to.light) {
        ASSERT_EQ(line.to.feed_milli, std::lround(options.feed_mm_min * 1000));
      }
    }
    const double run_up_steps = options.overscan_mm * 200 - 1;  // edges are rounded
    for (std::size_t row = 0; row < burnt.rows.size(); ++row) {
      EXPECT_GE(burnt.rows[row].dark_before, run_up_steps);
      EXPECT_GE(burnt.rows[row].dark_behind, run_up_steps);
      EXPECT_EQ(burnt.rows[row].way, row % 2 == 0 || options.one_way ? 1 : -1);
    }
  }
}

TEST(Rows, BlankRowsAndMarginsAreOmitted) {
  Pixels pixels{50, 5, std::vector<std::uint16_t>(250)};
  pixels.power[2 * 50 + 10] = pixels.power[2 * 50 + 12] = power_of_run(0.5);
  RowOptions options;
  options.feed_mm_min = 600;
  options.pitch_mm = 1;
  options.overscan_mm = 2.5;
  const job::Job job = make_rows(pixels, options, laser());
  ASSERT_EQ(job.size(), 2u);
  EXPECT_EQ(job.rows.lines[0].to.steps, (StepPosition{7 * 200, 400, 0, 0}));
  EXPECT_EQ(job.rows.lines[1].to.steps, (StepPosition{16 * 200, 400, 0, 0}));
  const std::uint16_t half = wire::max_run(power_of_run(0.5), 1);
  EXPECT_EQ(job.rows.runs,
            (std::vector<std::uint16_t>{wire::max_run(0, 3), half, wire::max_run(0, 1), half,
                                        wire::max_run(0, 3)}));
}

TEST(Rows, LongRowsAreDividedForTheTableOfRuns) {
  Pixels pixels{1000, 1, {}};
  for (int i = 0; i < 1000; ++i) pixels.power.push_back(power_of_run(i % 2 == 0 ? 0.3 : 0.7));
  RowOptions options = fast_rows(laser());
  options.corner.x = -50;
  const job::Job job = make_rows(pixels, options, laser());
  EXPECT_EQ(job.size(), 1u + 16);
  Burnt(job, pixels, options).expect_each_once();
}

TEST(Rows, MoreCellsThanALineMayHave) {
  const Pixels pixels{90'000, 1, std::vector<std::uint16_t>(90'000, power_of_run(1))};
  job::Profile profile = laser();
  job::state_setting(profile, Id::steps_per_mm_x, 1000, "test");
  RowOptions options;
  options.feed_mm_min = 600;
  options.pitch_mm = 0.00625;  // a step of Y
  options.corner.x = -99;
  EXPECT_THAT(test::error_of([&] { make_rows(pixels, options, profile); }), HasSubstr("outside"));
  job::state_setting(profile, Id::travel_x, 2000, "test");
  const job::Job job = make_rows(pixels, options, profile);
  EXPECT_EQ(job.size(), 3u);
  Burnt(job, pixels, options).expect_each_once();
}

TEST(Rows, ImpossiblePicturesAreErrors) {
  const Pixels black{10, 10, std::vector<std::uint16_t>(100, power_of_run(1))};
  const auto error = [&](const Pixels& pixels, auto change) {
    RowOptions options = fast_rows(laser());
    change(options);
    return test::error_of([&] { make_rows(pixels, options, laser()); });
  };
  const Pixels blank{10, 10, std::vector<std::uint16_t>(100)};
  EXPECT_THAT(error(blank, [](auto&) {}), HasSubstr("no pixel has any power"));
  EXPECT_THAT(error(black, [](auto& o) { o.feed_mm_min = 24'001; }), HasSubstr("24000 mm/min"));
  EXPECT_THAT(error(black, [](auto& o) { o.feed_mm_min = 0; }), HasSubstr("feed"));
  EXPECT_THAT(error(black, [](auto& o) { o.feed_mm_min = std::nan(""); }), HasSubstr("feed"));
  EXPECT_THAT(error(black, [](auto& o) { o.pitch_mm = 0.004; }), HasSubstr("0.005 mm or more"));
  EXPECT_THAT(error(black, [](auto& o) { o.pitch_mm = 0.006; }), HasSubstr("step of Y"));
  EXPECT_THAT(error(black, [](auto& o) { o.overscan_mm = -1; }), HasSubstr("overscan"));
  EXPECT_THAT(error(black, [](auto& o) { o.corner.x = -99; }), HasSubstr("outside"));
  EXPECT_THAT(error(black, [](auto& o) { o.corner.y = 49.1; }), HasSubstr("-50..50"));
  EXPECT_THAT(error(black, [](auto& o) { o.corner.z = 51; }), HasSubstr("outside"));
}

TEST(Pixels, PowerIsProportionalToGreyAndWhiteIsDark) {
  const model::Bitmap bitmap{3, 2, {0, 128, 255, 254, 64, 32}};
  const auto powers = [&](const PowerRange& range) {
    return make_pixels(bitmap, 3, 2, range).power;
  };
  const auto power = [](double p) { return power_of_run(p); };
  EXPECT_EQ(powers({}),
            (std::vector<std::uint16_t>{power(1 / 255.0), power(191 / 255.0), power(223 / 255.0),
                                        power(1), power(127 / 255.0), 0}));
  EXPECT_EQ(powers({0.2, 0.6, true}),
            (std::vector<std::uint16_t>{power(0.2 + 0.4 * 254 / 255), power(0.2 + 0.4 * 64 / 255),
                                        power(0.2 + 0.4 * 32 / 255), 0,
                                        power(0.2 + 0.4 * 128 / 255), power(0.6)}));
  EXPECT_EQ(power(1), 65'535);
  for (const PowerRange& wrong : {PowerRange{-0.1, 1}, {0, 1.1}, {0.6, 0.5}, {std::nan(""), 1}})
    EXPECT_THAT(test::error_of([&] { powers(wrong); }), HasSubstr("power"));
  EXPECT_THAT(test::error_of([&] { make_pixels({}, 1, 1, {}); }), HasSubstr("no pixels"));
}

TEST(Pixels, TransparentPixelsAreDark) {
  // Invisible, a quarter of black, black; then the same of white.
  const model::Bitmap bitmap{6, 1, {0, 0, 0, 255, 255, 255}, {0, 64, 255, 0, 64, 255}};
  EXPECT_EQ(make_pixels(bitmap, 6, 1, {0.3, 1}).power,
            (std::vector<std::uint16_t>{0, power_of_run(0.3 + 0.7 * 64 / 255), power_of_run(1), 0,
                                        0, 0}));
  EXPECT_EQ(make_pixels(bitmap, 6, 1, {0.3, 1, true}).power,
            (std::vector<std::uint16_t>{0, 0, 0, 0, power_of_run(0.3 + 0.7 * 64 / 255),
                                        power_of_run(1)}));
  EXPECT_EQ(make_pixels(bitmap, 2, 1, {0, 1}).at(1, 0), 0);
}

TEST(Pixels, OtherSizesAreMeansOfTheCoveredPixels) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(100); ++i) {
    model::Bitmap bitmap{
        static_cast<int>(1 + random() % 12), static_cast<int>(1 + random() % 12), {}};
    for (int n = bitmap.width * bitmap.height; n > 0; --n)
      bitmap.grey.push_back(static_cast<std::uint8_t>(random()));
    const auto columns = 1 + random() % 12, rows = 1 + random() % 12;
    const Pixels pixels = make_pixels(bitmap, columns, rows, {});
    // The total of ink is unchanged.
    double burnt = 0, ink = 0;
    for (const std::uint16_t power : pixels.power) burnt += power / 65'535.0;
    for (const std::uint8_t grey : bitmap.grey) ink += (255 - grey) / 255.0;
    EXPECT_NEAR(burnt / static_cast<double>(pixels.power.size()),
                ink / static_cast<double>(bitmap.grey.size()), 1.0 / 2048);
  }
  const model::Bitmap halves{2, 1, {0, 255}};
  EXPECT_EQ(make_pixels(halves, 3, 1, {}).power,
            (std::vector<std::uint16_t>{power_of_run(1), power_of_run(0.5), 0}));
  const model::Bitmap white{3, 3, std::vector<std::uint8_t>(9, 255)};
  for (const std::uint16_t power : make_pixels(white, 7, 5, {0.5, 1}).power) EXPECT_EQ(power, 0);
}

TEST(RunUp, EqualsTheTextbookWithoutALimitOfJerkAndIsLongerWithOne) {
  job::Profile profile = laser();
  EXPECT_NEAR(run_up_mm(profile.settings, 18'000), 22.5, 1e-9);
  EXPECT_NEAR(run_up_mm(profile.settings, 6000), 2.5, 1e-9);
  job::state_setting(profile, Id::jerk_x, 600, "test");
  EXPECT_GT(run_up_mm(profile.settings, 18'000), 23);
}

TEST(RowGcode, GivesTheSameLightAndThePlannersTime) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(25); ++i) {
    job::Profile profile = laser();
    if (i % 3 == 1) job::state_setting(profile, Id::jerk_x, 600, "test");
    if (i % 3 == 2) job::state_setting(profile, Id::max_spindle_speed, 255, "test");
    const Pixels pixels =
        random_pixels(1 + random() % 300, 1 + random() % 8, random, random() % 2 == 0 ? 1 : 40);
    RowOptions options = fast_rows(profile, 3000 + static_cast<double>(random() % 12'000));
    options.pitch_mm = i % 2 == 0 ? 0.1 : 0.0937;
    options.corner = {-15, -5, 0};
    const job::Job job = make_rows(pixels, options, profile);
    const PowerForm form = i % 2 == 0 ? PowerForm::plain : PowerForm::lists;
    const std::string text = row_gcode(job, form);
    if (form == PowerForm::plain) {
      EXPECT_EQ(text.find_first_of("*:"), std::string::npos)
          << "words that only this firmware knows";
    }
    const auto run = program_run::run_program(text, profile.settings, 10);
    SCOPED_TRACE(testing::Message() << "picture " << i);
    for (const auto& problem : run.problems) ADD_FAILURE() << problem.line << problem.text;
    // All pixels, from the pieces of the program.
    std::map<std::pair<std::int64_t, std::int64_t>, std::uint16_t> lit;
    for (const program_run::Piece& piece : run.pieces) {
      if (piece.rapid || piece.power == 0) continue;
      const double low = std::min(piece.from[0], piece.to[0]) - options.corner.x;
      const double high = std::max(piece.from[0], piece.to[0]) - options.corner.x;
      const auto row = static_cast<std::int64_t>(
          std::floor((piece.to[1] - options.corner.y) / options.pitch_mm));
      for (auto x = std::llround(low / options.pitch_mm); x < std::llround(high / options.pitch_mm);
           ++x)
        ASSERT_TRUE(lit.emplace(std::pair{x, row}, power_of_run(piece.power)).second);
    }
    const Burnt burnt(job, pixels, options);
    ASSERT_EQ(lit.size(), burnt.lit.size());
    for (const auto& [place, light] : burnt.lit) ASSERT_EQ(lit.at(place), light.power);
    // Longer lines have a longer look-ahead, and those of one pixel a shorter one.
    if (form == PowerForm::lists) {
      EXPECT_NEAR(seconds_of(job), run.seconds(), 0.01 * run.seconds() + 0.02);
    }
  }
}

}  // namespace
}  // namespace lamplock::raster
