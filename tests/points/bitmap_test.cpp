#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <stb/stb_image_write.h>

#include <set>

#include "host/file.hpp"
#include "host/geometry/bounds.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/points/bitmap_points.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using model::Bitmap;
using model::read_bitmap;
using points::bitmap_points;
using points::BitmapOptions;
using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

/// Written by another library than the reader's.
std::string png_of(unsigned width, unsigned height, const std::vector<std::uint8_t>& rgba,
                   const TemporaryFolder& folder) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGBA;
  const auto path = folder.file("written.png");
  EXPECT_NE(png_image_write_to_file(&image, path.c_str(), 0, rgba.data(), 0, nullptr), 0);
  return read_file(path);
}

/// A BMP of 24 bits, rows from the bottom: 2 x 2 pixels black, white / grey 100, white.
std::string small_bmp() {
  std::string bytes("BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x02\0\0\0\x01\0\x18\0", 30);
  bytes.append(24, '\0');
  bytes += std::string("ddd\xFF\xFF\xFF\0\0", 8);
  bytes += std::string("\0\0\0\xFF\xFF\xFF\0\0", 8);
  return bytes;
}

TEST(ReadBitmap, PngIsGreyOverWhite) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> rgba{0, 0, 0, 255, 255, 255, 255, 255, 0,  0,  0,  0,
                                       0, 0, 0, 128, 255, 0,   0,   255, 50, 50, 50, 255};
  const Bitmap bitmap = read_bitmap(folder.write("a.png", png_of(3, 2, rgba, folder)));
  EXPECT_EQ(bitmap.width, 3);
  EXPECT_EQ(bitmap.height, 2);
  EXPECT_EQ(bitmap.grey, (std::vector<std::uint8_t>{0, 255, 255, 127, 76, 50}));
}

/// A JPEG of the highest quality.
std::string jpeg_of(int width, int height, const std::vector<std::uint8_t>& grey) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                          static_cast<std::size_t>(size));
  };
  EXPECT_NE(stbi_write_jpg_to_func(append, &bytes, width, height, 1, grey.data(), 100), 0);
  return bytes;
}

TEST(ReadBitmap, JpegIsGrey) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> grey;
  grey.reserve(32 * 24);
  for (int i = 0; i < 32 * 24; ++i) grey.push_back(static_cast<std::uint8_t>(i % 32 * 8));
  const Bitmap bitmap = read_bitmap(folder.write("a.jpg", jpeg_of(32, 24, grey)));
  ASSERT_EQ(bitmap.width, 32);
  ASSERT_EQ(bitmap.height, 24);
  for (std::size_t i = 0; i < grey.size(); ++i) EXPECT_NEAR(bitmap.grey[i], grey[i], 4);
}

TEST(ReadBitmap, BmpIsUpright) {
  const TemporaryFolder folder;
  const Bitmap bitmap = read_bitmap(folder.write("a.bmp", small_bmp()));
  EXPECT_EQ(bitmap.width, 2);
  EXPECT_EQ(bitmap.grey, (std::vector<std::uint8_t>{0, 255, 100, 255}));
}

TEST(ReadBitmap, TruncatedAndForeignFilesAreRefused) {
  const TemporaryFolder folder;
  std::mt19937_64 random(3);
  std::vector<std::uint8_t> rgba(40 * 30 * 4);
  for (auto& value : rgba) value = static_cast<std::uint8_t>(random());
  for (const auto& [name, bytes] :
       {std::pair{"a.png", png_of(40, 30, rgba, folder)}, std::pair{"a.bmp", small_bmp()},
        std::pair{"a.jpg", jpeg_of(40, 30, rgba)}}) {
    const std::size_t stride = bytes.size() / 40 + 1;
    for (std::size_t size = 0; size < bytes.size(); size += stride) {
      const auto path = folder.write(name, bytes.substr(0, size));
      EXPECT_THAT(error_of([&] { read_bitmap(path); }), HasSubstr(name)) << size;
    }
    const auto path = folder.write(name, bytes.substr(0, bytes.size() - 1));
    EXPECT_NE(error_of([&] { read_bitmap(path); }), "");
  }
  const auto text = folder.write("b.png", "no picture at all");
  EXPECT_THAT(error_of([&] { read_bitmap(text); }), HasSubstr("is not a PNG, BMP or JPEG"));
  const auto grey_map = folder.write("c.png", std::string("P5 1 1 255\n") + '\0');
  EXPECT_THAT(error_of([&] { read_bitmap(grey_map); }), HasSubstr("is not a PNG, BMP or JPEG"));
  EXPECT_THAT(error_of([&] { read_bitmap(folder.file("none.png")); }), HasSubstr("no such file"));
}

TEST(ReadBitmap, DamagedFilesAtWorstFail) {
  const TemporaryFolder folder;
  const std::string png = png_of(8, 8, std::vector<std::uint8_t>(256, 77), folder),
                    bmp = small_bmp(), jpeg = jpeg_of(16, 16, std::vector<std::uint8_t>(256, 77));
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(250); ++i) {
    const std::string& whole = i % 3 == 0 ? png : i % 3 == 1 ? bmp : jpeg;
    std::string bytes = whole;
    bytes[random() % std::min<std::size_t>(bytes.size(), i % 3 == 2 ? 800 : 60)] =
        static_cast<char>(random());
    const auto path = folder.write("a.png", bytes);
    try {
      const Bitmap bitmap = read_bitmap(path);
      EXPECT_EQ(bitmap.grey.size(),
                static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height));
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::bad_input);
    }
  }
}

TEST(BitmapPoints, PixelsBecomePointsUprightAndCentred) {
  // # .
  // # #   left -x, top +y
  const Bitmap bitmap{2, 2, {0, 200, 10, 127}};
  const auto cloud = bitmap_points(bitmap, {.size_mm = 2, .spacing_mm = 1});
  EXPECT_EQ(cloud, (geometry::PointCloud{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {-0.5, 0.5, 0}}));
  const auto inverted = bitmap_points(bitmap, {.size_mm = 2, .spacing_mm = 1, .invert = true});
  EXPECT_EQ(inverted, (geometry::PointCloud{{0.5, 0.5, 0}}));
  EXPECT_EQ(bitmap_points(bitmap, {.size_mm = 2, .spacing_mm = 1, .threshold = 10}).size(), 1u);
  EXPECT_EQ(bitmap_points(bitmap, {.size_mm = 2, .spacing_mm = 1, .threshold = 0}).size(), 0u);
}

TEST(BitmapPoints, LayersAreStackedRoundZero) {
  const auto cloud =
      bitmap_points({1, 1, {0}}, {.size_mm = 1, .spacing_mm = 1, .layers = 3, .layer_mm = 0.5});
  EXPECT_EQ(cloud, (geometry::PointCloud{{0, 0, -0.5}, {0, 0, 0}, {0, 0, 0.5}}));
}

TEST(BitmapPoints, GridHasTheSpacingForAnyPixels) {
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(50); ++i) {
    const int width = 1 + static_cast<int>(random() % 60),
              height = 1 + static_cast<int>(random() % 60);
    const Bitmap black{width, height,
                       std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 0)};
    BitmapOptions options;
    options.size_mm = 5 + static_cast<double>(random() % 100) / 10;
    options.spacing_mm = 0.2 + static_cast<double>(random() % 10) / 20;
    const auto cloud = bitmap_points(black, options);
    const double scale = options.size_mm / std::max(width, height);
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
  EXPECT_EQ(bitmap_points(board, {.size_mm = 8, .spacing_mm = 2, .threshold = 128}).size(), 16u);
  EXPECT_EQ(bitmap_points(board, {.size_mm = 8, .spacing_mm = 2, .threshold = 127}).size(), 0u);
}

TEST(BitmapPoints, WrongOptionsAreRefused) {
  const Bitmap bitmap{1, 1, {0}};
  for (const BitmapOptions& options : {BitmapOptions{.size_mm = 0}, BitmapOptions{.spacing_mm = -1},
                                       BitmapOptions{.threshold = 256}, BitmapOptions{.layers = 0},
                                       BitmapOptions{.layers = 2, .layer_mm = 0},
                                       BitmapOptions{.size_mm = 1e9, .spacing_mm = 1e-3}}) {
    EXPECT_NE(error_of([&] { bitmap_points(bitmap, options); }), "");
  }
  EXPECT_NE(error_of([&] { bitmap_points({0, 0, {}}, {}); }), "");
}

}  // namespace
}  // namespace lamplock
