// Pictures to points: alpha x invert x tone x orientation x depth x way to one size give one cloud,
// with points only where they belong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>

#include "host/glass/volume.hpp"
#include "host/run/discretise.hpp"
#include "tests/error_of.hpp"
#include "tests/picture_files.hpp"
#include "tests/run/silent_frontend.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using glass::Object;
using test::png_chunk;
using test::png_file;
using test::PngType;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double spacing_mm = 0.25;

/// A block with room for 36 x 50 x 14 mm round (5, -3, 2).
glass::Volume volume() {
  glass::GlassChoice choice;
  choice.block_mm = {42, 56, 20};
  choice.block_at_mm = {5, -3, 2};
  return glass::volume_of(choice, {{-50, -50, -50}, {50, 50, 50}});
}

run::ObjectPoints points_of(const Object& object) {
  test::SilentFrontend frontend;
  return run::object_points(object, {}, volume(), frontend);
}

/// Points relative to the middle of the block.
PointCloud cloud_of(const Object& object) {
  PointCloud cloud = points_of(object).points;
  for (Point& p : cloud) p = {p.x - 5, p.y + 3, p.z - 2};
  return cloud;
}

/// Columns of the picture, each a quarter of its width: invisible black, invisible white, opaque
/// ink, ink of which a quarter is there. Ink is what becomes points.
constexpr int width = 48, height = 32, columns = 4;

struct Pixel {
  std::uint32_t grey, alpha;
};

Pixel pixel_at(int x, bool invert) {
  const std::uint32_t ink = invert ? 255 : 0;
  const std::array<Pixel, columns> kinds{{{0, 0}, {255, 0}, {ink, 255}, {ink, 64}}};
  return kinds[static_cast<std::size_t>(x * columns / width)];
}

/// What a camera with this orientation stores: the place in the upright picture of what is in a
/// place of the file. Orientations 5 to 8 exchange rows and columns.
std::pair<int, int> upright_place(int orientation, int column, int row) {
  const int right = width - 1, bottom = height - 1;
  switch (orientation) {
    case 2:
      return {right - column, row};
    case 3:
      return {right - column, bottom - row};
    case 4:
      return {column, bottom - row};
    case 5:
      return {row, column};
    case 6:
      return {right - row, column};
    case 7:
      return {right - row, bottom - column};
    case 8:
      return {row, bottom - column};
    default:
      return {column, row};
  }
}

enum class Form { grey_alpha_8, grey_alpha_16, rgb_alpha_8, rgb_alpha_16, palette };

/// The picture in a form of PNG.
std::string picture(Form form, int orientation, bool invert) {
  const int file_width = orientation >= 5 ? height : width;
  const int file_height = width + height - file_width;
  const bool deep = form == Form::grey_alpha_16 || form == Form::rgb_alpha_16;
  const std::uint32_t factor = deep ? 257 : 1;
  const bool rgb = form == Form::rgb_alpha_8 || form == Form::rgb_alpha_16;
  std::vector<std::uint32_t> samples;
  for (int row = 0; row < file_height; ++row) {
    for (int column = 0; column < file_width; ++column) {
      const int x = upright_place(orientation, column, row).first;
      const auto [grey, alpha] = pixel_at(x, invert);
      if (form == Form::palette) {
        samples.push_back(static_cast<std::uint32_t>(x * columns / width));
        continue;
      }
      for (int i = 0; i < (rgb ? 3 : 1); ++i) samples.push_back(grey * factor);
      samples.push_back(alpha * factor);
    }
  }
  std::string chunks;
  if (form == Form::palette) {
    std::string colours, alphas;
    for (int kind = 0; kind < columns; ++kind) {
      const Pixel pixel = pixel_at(kind * width / columns, invert);
      colours += std::string(3, static_cast<char>(pixel.grey));
      alphas += static_cast<char>(pixel.alpha);
    }
    chunks = png_chunk("PLTE", colours) + png_chunk("tRNS", alphas);
  }
  const PngType type = form == Form::palette ? PngType::palette
                       : rgb                 ? PngType::rgb_alpha
                                             : PngType::grey_alpha;
  return png_file(file_width, file_height,
                  form == Form::palette ? 2
                  : deep                ? 16
                                        : 8,
                  type, samples, chunks + png_chunk("eXIf", test::exif_block(orientation)));
}

struct Way {
  double size_mm;
  std::vector<std::string> transform;
  bool left_is_right = false;  ///< in the glass
};

/// Ways to 36 x 24 mm in the middle of the block.
std::vector<Way> ways() {
  return {{36, {}},
          {12, {"scale 3"}},
          {360, {"scale 0.1"}},
          {12, {"fit"}},
          {5, {"fit"}},
          {170, {"move 3 4 5", "fit"}},
          {24, {"scale 3 3 0.5", "scale 0.5"}},
          {36, {"move 1 2 3", "centre"}},
          {12, {"rotate z 37", "scale 3", "rotate z -37"}},
          {36, {"mirror y"}},
          {36, {"mirror z"}},
          {12, {"mirror x", "scale 3"}, true},
          {36, {"rotate z 180"}, true},
          {12, {"rotate x 90", "scale 3", "rotate x -90"}},
          {12, {"rotate y 180", "fit"}, true}};
}

/// Points of the quarters of the picture from the left, per grid point.
std::array<double, columns> densities(const PointCloud& cloud, bool left_is_right) {
  constexpr double grid_points = 9 * 24 / (spacing_mm * spacing_mm);
  std::array<double, columns> counts{};
  for (const Point& p : cloud) {
    EXPECT_LT(std::abs(p.x), 18);
    EXPECT_LT(std::abs(p.y), 12);
    EXPECT_NEAR(p.z, 0, 1e-9);
    const double x = left_is_right ? -p.x : p.x;
    counts[static_cast<std::size_t>(std::clamp((x + 18) / 9, 0.0, 3.0))] += 1 / grid_points;
  }
  return counts;
}

class PictureMatrix : public testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(PictureMatrix, EveryWayToASizeHasTheDensity) {
  const auto [invert, tone] = GetParam();
  const TemporaryFolder folder;
  Object object;
  object.file = folder.write("a.png", picture(Form::grey_alpha_8, 1, invert));
  object.spacing_mm = spacing_mm;
  object.invert = invert;
  object.tone = tone;
  for (const Way& way : ways()) {
    object.size_mm = way.size_mm;
    object.transform = way.transform;
    const std::array<double, columns> found = densities(cloud_of(object), way.left_is_right);
    SCOPED_TRACE(testing::Message() << way.size_mm << ' ' << testing::PrintToString(way.transform));
    EXPECT_EQ(found[0], 0);
    EXPECT_EQ(found[1], 0);
    EXPECT_NEAR(found[2], 1, 1e-9);
    EXPECT_NEAR(found[3], tone ? std::pow(64 / 255.0, object.gamma) : 0, tone ? 0.01 : 0);
  }
}

TEST_P(PictureMatrix, EveryFormIsTheSameCloud) {
  const auto [invert, tone] = GetParam();
  const TemporaryFolder folder;
  Object object;
  object.file = folder.write("a.png", picture(Form::grey_alpha_8, 1, invert));
  object.size_mm = 36;
  object.spacing_mm = spacing_mm;
  object.invert = invert;
  object.tone = tone;
  object.tone_lowest = tone ? 0.2 : 0;
  const PointCloud expected = cloud_of(object);
  EXPECT_GT(expected.size(), 3000u);
  for (const Form form : {Form::grey_alpha_8, Form::grey_alpha_16, Form::rgb_alpha_8,
                          Form::rgb_alpha_16, Form::palette}) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
      object.file = folder.write("b.png", picture(form, orientation, invert));
      EXPECT_EQ(cloud_of(object), expected) << static_cast<int>(form) << ' ' << orientation;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(all, PictureMatrix, testing::Combine(testing::Bool(), testing::Bool()));

/// The blocks of a picture of 6 x 4, of which the upper left quarter and the corner are ink.
int block_at(int x, int y) { return (x < 3 && y < 2) || (x == 5 && y == 3) ? 0 : 255; }

TEST(PictureForms, JpegOfEveryOrientationIsTheCloudOfThePng) {
  const TemporaryFolder folder;
  std::vector<std::uint32_t> upright;
  for (int i = 0; i < 24; ++i)
    upright.push_back(static_cast<std::uint32_t>(block_at(i % 6, i / 6)));
  Object object;
  object.size_mm = 6;
  object.spacing_mm = spacing_mm;
  object.file = folder.write("a.png", png_file(6, 4, 8, PngType::grey, upright));
  const PointCloud expected = cloud_of(object);
  EXPECT_EQ(expected.size(), 7u * 16);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const int file_width = orientation >= 5 ? 4 : 6, file_height = 10 - file_width;
    std::vector<int> stored, inks;
    for (int row = 0; row < file_height; ++row) {
      for (int column = 0; column < file_width; ++column) {
        // In pixels of the picture of 48 x 32, whose blocks are of 8 x 8.
        const auto [x, y] = upright_place(orientation, column * 8, row * 8);
        stored.push_back(block_at(x / 8, y / 8));
        inks.insert(inks.end(), {255, 255, 255, stored.back()});
      }
    }
    object.file = folder.write("b.jpg", test::jpeg_of_blocks(file_width, file_height, 1, stored,
                                                             test::jpeg_exif(orientation)));
    EXPECT_EQ(cloud_of(object), expected) << orientation;
    object.file = folder.write(
        "c.jpg", test::jpeg_of_blocks(file_width, file_height, 4, inks,
                                      test::jpeg_adobe(0) + test::jpeg_exif(orientation)));
    EXPECT_EQ(cloud_of(object), expected) << orientation;
  }
}

/// The density is that of the glass after any map, and the distances too.
TEST(PictureForms, AnyTransformationKeepsSpacingAndDensity) {
  const TemporaryFolder folder;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-180, 180), factor(0.3, 1.5);
  Object object;
  object.file = folder.write("a.png", png_file(1, 1, 8, PngType::grey, {0}));
  object.size_mm = 6;
  object.spacing_mm = 0.04;
  for (int i = 0; i < test::scaled(20); ++i) {
    const double x = factor(random), y = factor(random);
    object.transform = {fmt::format("rotate z {}", angle(random)),
                        fmt::format("scale {} {} 1", x, y),
                        fmt::format("rotate x {}", angle(random)), "centre"};
    const PointCloud cloud = cloud_of(object);
    const double expected = 36 * x * y / (0.04 * 0.04);
    EXPECT_NEAR(static_cast<double>(cloud.size()), expected, 0.02 * expected) << x << ' ' << y;
    for (std::size_t k = 1; k < cloud.size(); ++k) {
      const Point &p = cloud[k - 1], &q = cloud[k];
      ASSERT_GE(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z), 0.04 - 1e-9);
    }
  }
}

TEST(PictureForms, LayersAreOffsetAndTheirDistanceIsInTheGlass) {
  const TemporaryFolder folder;
  Object object;
  object.file = folder.write("a.png", png_file(2, 2, 8, PngType::grey, {0, 0, 0, 0}));
  object.size_mm = 2;
  object.spacing_mm = spacing_mm;
  object.layers = 5;
  object.layer_mm = 0.5;
  object.transform = {"scale 3"};
  const PointCloud cloud = cloud_of(object);
  EXPECT_EQ(cloud.size(), 5u * 24 * 24);
  std::set<std::pair<long, long>> places;
  std::set<long> heights;
  for (const Point& p : cloud) {
    EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 3);
    places.emplace(std::lround(p.x * 1000), std::lround(p.y * 1000));
    heights.insert(std::lround(p.z * 1000));
  }
  EXPECT_EQ(places.size(), cloud.size());
  EXPECT_EQ(heights, (std::set<long>{-1000, -500, 0, 500, 1000}));
  // The layers need 2 mm of the room, whatever the scale; upright they limit the height of a fit.
  object.transform = {"rotate y 90", "fit"};
  for (const Point& p : cloud_of(object)) {
    EXPECT_LE(std::abs(p.x), 1 + 1e-9);
    EXPECT_LE(std::abs(p.z), 7);
  }
  object.layers = 100;
  EXPECT_THAT(test::error_of([&] {
                object.transform = {"fit"};
                points_of(object);
              }),
              HasSubstr("layers that are thicker"));
}

TEST(PictureForms, APhotoWithoutToneWarns) {
  const TemporaryFolder folder;
  std::vector<std::uint32_t> ramp, drawing;
  for (std::uint32_t i = 0; i < 256; ++i) {
    ramp.push_back(i);
    drawing.push_back(i % 2 == 0 ? 0 : 255);
  }
  Object object;
  object.size_mm = 5;
  object.file = folder.write("a.png", png_file(16, 16, 8, PngType::grey, ramp));
  EXPECT_THAT(points_of(object).warnings, testing::ElementsAre(HasSubstr("turn on tone")));
  object.tone = true;
  EXPECT_THAT(points_of(object).warnings, testing::IsEmpty());
  object.tone = false;
  object.file = folder.write("b.png", png_file(16, 16, 8, PngType::grey, drawing));
  EXPECT_THAT(points_of(object).warnings, testing::IsEmpty());
}

/// A picture of another format is refused by its content and by its extension.
TEST(PictureForms, OtherFormatsAreRefusedWithAHint) {
  const TemporaryFolder folder;
  Object object;
  const std::string gif("GIF89a\1\0\1\0\0\0\0;", 14);
  for (const char* name : {"a.gif", "a.png", "a.tiff", "a.webp"}) {
    object.file = folder.write(name, gif);
    EXPECT_THAT(test::error_of([&] { points_of(object); }),
                testing::AllOf(HasSubstr(name), HasSubstr("GIF"), HasSubstr("convert it to PNG")));
  }
  // The content decides.
  object.file = folder.write("b.gif", png_file(1, 1, 8, PngType::grey, {0}));
  object.size_mm = 5;
  EXPECT_EQ(points_of(object).points.size(), 50u * 50);
}

}  // namespace
}  // namespace lamplock
