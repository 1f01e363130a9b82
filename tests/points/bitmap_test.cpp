#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "host/geometry/bounds.hpp"
#include "host/model/bitmap.hpp"
#include "host/points/bitmap_points.hpp"
#include "tests/points/picture_points.hpp"
#include "tests/points/sampling.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using model::Bitmap;
using points::BitmapOptions;
using test::error_of;
using test::picture_points;
using ::testing::HasSubstr;

TEST(BitmapPoints, PixelsBecomePointsUprightAndCentred) {
  // # .
  // # #   left -x, top +y
  const Bitmap bitmap{2, 2, {0, 200, 10, 127}};
  const auto cloud = picture_points(bitmap, 2, {.spacing_mm = 1});
  EXPECT_EQ(cloud, (geometry::PointCloud{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {-0.5, 0.5, 0}}));
  const auto inverted = picture_points(bitmap, 2, {.spacing_mm = 1, .invert = true});
  EXPECT_EQ(inverted, (geometry::PointCloud{{0.5, 0.5, 0}}));
  EXPECT_EQ(picture_points(bitmap, 2, {.spacing_mm = 1, .threshold = 10}).size(), 1u);
  EXPECT_EQ(picture_points(bitmap, 2, {.spacing_mm = 1, .threshold = 0}).size(), 0u);
}

TEST(BitmapPoints, LayersAreStackedRoundZeroAndOffset) {
  const BitmapOptions options{.spacing_mm = 1, .layers = 9, .layer_mm = 0.5};
  const auto cloud = picture_points({20, 10, std::vector<std::uint8_t>(200, 0)}, 20, options);
  ASSERT_EQ(cloud.size(), 9u * 200);
  std::set<std::pair<long, long>> columns;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].z, (static_cast<double>(i / 200) - 4) * 0.5);
    EXPECT_LE(std::abs(cloud[i].x), 10);
    EXPECT_LE(std::abs(cloud[i].y), 5);
    columns.emplace(std::lround(cloud[i].x * 20), std::lround(cloud[i].y * 20));
  }
  EXPECT_EQ(columns.size(), cloud.size());  // none within a twentieth of the spacing of another
  // The distance to the next layer is more than the layers' own.
  for (std::size_t i = 0; i < 200; ++i)
    for (std::size_t k = 200; k < 400; ++k)
      EXPECT_GT(test::distance(cloud[i], cloud[k]), std::hypot(0.5, 0.5));
  // A picture smaller than the spacing.
  for (const auto& p : picture_points({1, 1, {0}}, 0.2, options))
    EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 0.1);
}

TEST(BitmapPoints, GridHasTheSpacingForAnyPixels) {
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(50); ++i) {
    const int width = 1 + static_cast<int>(random() % 60),
              height = 1 + static_cast<int>(random() % 60);
    const Bitmap black{width, height,
                       std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 0)};
    BitmapOptions options;
    const double size_mm = 5 + static_cast<double>(random() % 100) / 10;
    options.spacing_mm = 0.2 + static_cast<double>(random() % 10) / 20;
    const auto cloud = picture_points(black, size_mm, options);
    const double scale = size_mm / std::max(width, height);
    const auto count = [&](int pixels) {
      return std::max(1.0, std::floor(pixels * scale / options.spacing_mm + 1e-9));
    };
    EXPECT_EQ(static_cast<double>(cloud.size()), count(width) * count(height));
    const auto box = geometry::bounds(cloud);
    EXPECT_NEAR(box.low.x + box.high.x, 0, 1e-9);
    EXPECT_NEAR(box.low.y + box.high.y, 0, 1e-9);
    EXPECT_NEAR(box.high.x - box.low.x, (count(width) - 1) * options.spacing_mm, 1e-9);
  }
}

TEST(BitmapPoints, CoarsePointsHaveTheMeanOfTheirPixels) {
  // A chequerboard has mean 127.5 in every square of even side.
  Bitmap board{8, 8, {}};
  for (int i = 0; i < 64; ++i) {
    board.grey.push_back((i + i / 8) % 2 == 0 ? std::uint8_t{0} : std::uint8_t{255});
  }
  EXPECT_EQ(picture_points(board, 8, {.spacing_mm = 2, .threshold = 128}).size(), 16u);
  EXPECT_EQ(picture_points(board, 8, {.spacing_mm = 2, .threshold = 127}).size(), 0u);
}

TEST(BitmapPoints, WrongOptionsAreRefused) {
  const Bitmap bitmap{1, 1, {0}};
  for (const BitmapOptions& options :
       {BitmapOptions{.spacing_mm = -1}, BitmapOptions{.threshold = 256},
        BitmapOptions{.layers = 0}, BitmapOptions{.layers = 2, .layer_mm = 0}})
    EXPECT_NE(error_of([&] { picture_points(bitmap, 50, options); }), "");
  EXPECT_NE(error_of([&] { picture_points(bitmap, 0, {}); }), "");
  EXPECT_NE(error_of([&] { picture_points(bitmap, 1e9, {.spacing_mm = 1e-3}); }), "");
  EXPECT_NE(error_of([&] { picture_points({0, 0, {}}, 50, {}); }), "");
  // A picture without points takes its time as well.
  const Bitmap blank{1, 1, {255}};
  EXPECT_THAT(error_of([&] { picture_points(blank, 400, {.spacing_mm = 0.1, .layers = 10'000}); }),
              HasSubstr("grid points"));
}

}  // namespace
}  // namespace lamplock
