// Pictures with palettes: colours outside of them, and palettes that do not fit, are refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "tests/error_of.hpp"
#include "tests/picture_files.hpp"

namespace lamplock::picture_palette_test {
namespace {

using model::Bitmap;
using model::decode_bitmap;
using test::error_of;
using test::png_chunk;
using test::png_file;
using test::PngType;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Samples = std::vector<std::uint32_t>;

/// A PNG with a palette of grey colours 0, 10, 20 ...
std::string png_of_palette(int depth, const Samples& numbers, std::size_t colours,
                           const std::string& more = "") {
  std::string palette;
  for (std::size_t i = 0; i < colours; ++i) palette += std::string(3, static_cast<char>(10 * i));
  return png_file(static_cast<int>(numbers.size()), 1, depth, PngType::palette, numbers,
                  png_chunk("PLTE", palette) + more);
}

TEST(ReadPalette, ColoursOutsideThePaletteAreRefused) {
  for (const int depth : {1, 2, 4, 8}) {
    const std::uint32_t last = (1U << depth) - 1;
    for (std::uint32_t colours = 1; colours <= std::min(last + 1, 20U); ++colours) {
      const std::uint32_t fitting = colours - 1;
      const Bitmap bitmap = decode_bitmap("a.png", png_of_palette(depth, {0, fitting}, colours));
      EXPECT_EQ(bitmap.grey, (Bytes{0, static_cast<std::uint8_t>(10 * fitting)}));
      for (const std::uint32_t bad : {colours, last}) {
        if (bad < colours || bad > last) continue;
        const std::string bytes = png_of_palette(depth, {0, fitting, bad}, colours);
        EXPECT_THAT(error_of([&] { decode_bitmap("a.png", bytes); }),
                    HasSubstr(fmt::format("pixel 3, 1 has colour {} of a palette of {} colour",
                                          bad + 1, colours)));
      }
    }
  }
}

TEST(ReadPalette, PalettesThatDoNotFitAreRefused) {
  const auto error = [](PngType type, const Samples& samples, const std::string& chunks) {
    const std::string bytes = png_file(1, 1, 8, type, samples, chunks);
    return error_of([&] { decode_bitmap("a.png", bytes); });
  };
  const auto is_read = [](PngType type, const Samples& samples, const std::string& chunks) {
    EXPECT_NO_THROW(decode_bitmap("a.png", png_file(1, 1, 8, type, samples, chunks)));
  };
  const auto of_palette = [&](const std::string& chunks) {
    return error(PngType::palette, {0}, chunks);
  };
  const auto palette = [](std::size_t bytes) { return png_chunk("PLTE", std::string(bytes, 'd')); };
  const auto transparency = [](std::size_t bytes) {
    return png_chunk("tRNS", std::string(bytes, '\x50'));
  };
  is_read(PngType::palette, {0}, palette(6) + transparency(2));
  is_read(PngType::palette, {0}, palette(6) + transparency(1));
  EXPECT_THAT(of_palette(""), HasSubstr("it has no palette"));
  EXPECT_THAT(of_palette(palette(3) + palette(3)), HasSubstr("more than one palette"));
  EXPECT_THAT(of_palette(palette(4)), HasSubstr("its palette has 4 bytes"));
  EXPECT_THAT(of_palette(palette(0)), HasSubstr("its palette has 0 bytes"));
  EXPECT_THAT(of_palette(palette(6) + transparency(3)),
              HasSubstr("3 transparencies for a palette of 2 colours"));
  EXPECT_THAT(of_palette(transparency(1) + palette(6)), HasSubstr("come before the palette"));
  EXPECT_THAT(of_palette(palette(6) + transparency(1) + transparency(1)),
              HasSubstr("more than one list of transparencies"));
  is_read(PngType::grey, {7}, transparency(2));
  EXPECT_THAT(error(PngType::grey, {7}, transparency(1)), HasSubstr("has 1 byte)"));
  is_read(PngType::rgb, {7, 7, 7}, transparency(6));
  EXPECT_THAT(error(PngType::rgb, {7, 7, 7}, transparency(2)), HasSubstr("has 2 bytes)"));
  // Chunks after the pixels.
  const auto moved_to_end = [](std::string bytes, const std::string& chunk) {
    bytes.erase(bytes.find(chunk), chunk.size());
    return bytes.insert(bytes.size() - 12, chunk);
  };
  const std::string whole = png_of_palette(8, {0, 1}, 2, transparency(1));
  EXPECT_THAT(error_of([&] { decode_bitmap("a.png", moved_to_end(whole, transparency(1))); }),
              HasSubstr("its transparencies follow the pixels"));
  const std::string colours = png_chunk("PLTE", std::string("\0\0\0\n\n\n", 6));
  EXPECT_THAT(error_of([&] { decode_bitmap("a.png", moved_to_end(whole, colours)); }),
              HasSubstr("its palette follows the pixels"));
}

/// A BMP with a palette of grey colours 0, 10, 20 ...: one row of at most 4 bytes.
std::string bmp_of_palette(int bits, const std::string& row, std::size_t pixels,
                           std::size_t colours) {
  const auto number = [](std::size_t value) {
    std::string text = test::big_endian(static_cast<std::uint32_t>(value), 4);
    std::reverse(text.begin(), text.end());
    return text;
  };
  std::string bytes = "BM" + number(0) + number(0) + number(54 + 4 * colours) + number(40) +
                      number(pixels) + number(1) + std::string("\1\0", 2) +
                      static_cast<char>(bits) + std::string(25, '\0');
  for (std::size_t i = 0; i < colours; ++i)
    bytes += std::string(3, static_cast<char>(10 * i)) + '\0';
  return bytes + row + std::string(4 - row.size(), '\0');
}

TEST(ReadPalette, ColoursOutsideThePaletteOfABmpAreRefused) {
  EXPECT_EQ(decode_bitmap("a.bmp", bmp_of_palette(8, "\2\1", 2, 3)).grey, (Bytes{20, 10}));
  EXPECT_EQ(decode_bitmap("a.bmp", bmp_of_palette(4, "\x21\x10", 3, 3)).grey, (Bytes{20, 10, 10}));
  EXPECT_EQ(decode_bitmap("a.bmp", bmp_of_palette(1, "\xA0", 3, 2)).grey, (Bytes{10, 0, 10}));
  EXPECT_THAT(error_of([] { decode_bitmap("a.bmp", bmp_of_palette(8, "\2\3", 2, 3)); }),
              HasSubstr("a pixel has colour 4 of a palette of 3 colours"));
  EXPECT_THAT(error_of([] { decode_bitmap("a.bmp", bmp_of_palette(4, "\x21\x40", 3, 3)); }),
              HasSubstr("a pixel has colour 5 of a palette of 3 colours"));
}

}  // namespace
}  // namespace lamplock::picture_palette_test
