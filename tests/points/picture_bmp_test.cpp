// BMP: one picture in every depth and header, top row first or last; compressed ones are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host/bytes.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "tests/error_of.hpp"

namespace lamplock::picture_bmp_test {
namespace {

using model::Bitmap;
using model::decode_bitmap;
using test::error_of;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t core_header = 12, os2_header = 64;

struct BmpForm {
  std::uint32_t header = 40;
  unsigned bits = 24;
  std::uint32_t compression = 0;
  bool from_top = false;
};

/// A row of grey pixels, which are multiples of 255 / 1 for 1 bit, 255 / 3 for 2 bits and so on.
std::string row_of(const BmpForm& form, const std::uint8_t* grey, int width) {
  std::string row;
  std::uint32_t filled = 0, byte = 0;
  for (int x = 0; x < width; ++x) {
    const std::uint32_t value = grey[x];
    if (form.bits == 16) append(row, static_cast<std::uint16_t>((value >> 3) * 0x421));
    if (form.bits == 24) row += std::string(3, static_cast<char>(value));
    if (form.bits == 32) append(row, 0xff000000 | value * 0x10101);
    if (form.bits > 8) continue;
    byte = byte << form.bits | value * ((1U << form.bits) - 1) / 255;
    filled += form.bits;
    if (filled == 8) row += static_cast<char>(byte), filled = byte = 0;
  }
  if (filled != 0) row += static_cast<char>(byte << (8 - filled));
  row.resize((row.size() + 3) / 4 * 4);
  return row;
}

/// A BMP of grey pixels, row by row from the top. A palette has all its greys.
std::string bmp_file(const BmpForm& form, const Bytes& grey, int width, int height) {
  const bool core = form.header == core_header;
  std::string header;
  append(header, form.header);
  if (core) {
    append(header, static_cast<std::uint16_t>(width));
    append(header, static_cast<std::uint16_t>(height));
  } else {
    append(header, static_cast<std::int32_t>(width));
    append(header, static_cast<std::int32_t>(form.from_top ? -height : height));
  }
  append(header, std::uint16_t{1});
  append(header, static_cast<std::uint16_t>(form.bits));
  if (!core) append(header, form.compression);
  header.resize(form.header);
  const unsigned colours = form.bits <= 8 ? 1U << form.bits : 0;
  for (unsigned i = 0; i < colours; ++i) {
    header += std::string(3, static_cast<char>(i * 255 / (colours - 1)));
    if (!core) header += '\0';
  }
  std::string file = "BM";
  append(file, std::uint32_t{0});
  append(file, std::uint32_t{0});
  append(file, static_cast<std::uint32_t>(14 + header.size()));
  file += header;
  for (int y = 0; y < height; ++y) {
    const int from = form.from_top ? y : height - 1 - y;
    file += row_of(form, grey.data() + from * width, width);
  }
  return file;
}

Bytes random_greys(unsigned bits, std::size_t count) {
  static std::mt19937 random(11);
  // 16 bits have five for each colour; a value of those is one of 32 greys.
  const unsigned levels = bits <= 8 ? 1U << bits : bits == 16 ? 32 : 256;
  Bytes grey;
  for (std::size_t i = 0; i < count; ++i)
    grey.push_back(
        static_cast<std::uint8_t>((random() % levels * 255 + (levels - 1) / 2) / (levels - 1)));
  return grey;
}

TEST(PictureBmp, EveryDepthAndHeaderIsReadRight) {
  for (const std::uint32_t header : {12U, 40U, 52U, 56U, 64U, 108U, 124U}) {
    for (const unsigned bits : {1U, 2U, 4U, 8U, 16U, 24U, 32U}) {
      for (const bool from_top : {false, true}) {
        if (header == core_header && from_top) continue;
        for (const int width : {1, 7, 13, 40}) {
          constexpr int height = 3;
          const BmpForm form{header, bits, 0, from_top};
          const Bytes grey = random_greys(bits, static_cast<std::size_t>(width * height));
          const Bitmap read = decode_bitmap("a.bmp", bmp_file(form, grey, width, height));
          ASSERT_EQ(read.width, width);
          ASSERT_EQ(read.height, height);
          EXPECT_EQ(read.grey, grey) << header << " bytes of header, " << bits << " bits";
          EXPECT_TRUE(read.alpha.empty());
        }
      }
    }
  }
}

TEST(PictureBmp, CutOffIsRefused) {
  for (const std::uint32_t header : {12U, 40U, 124U}) {
    for (const unsigned bits : {1U, 8U, 24U}) {
      const std::string whole = bmp_file({header, bits, 0, false}, random_greys(bits, 15), 5, 3);
      for (std::size_t size = 2; size < whole.size(); ++size)
        EXPECT_THAT(error_of([&] { decode_bitmap("a.bmp", whole.substr(0, size)); }),
                    HasSubstr("cut off"))
            << size;
    }
  }
}

TEST(PictureBmp, CompressedIsNamed) {
  const Bytes grey(6, 255);
  // RLE8, RLE4, JPEG and PNG; RLE24 of OS/2; CMYK, plain and RLE.
  for (const auto& [header, bits, compression] :
       {std::array{40U, 8U, 1U}, std::array{40U, 4U, 2U}, std::array{124U, 24U, 4U},
        std::array{124U, 24U, 5U}, std::array{os2_header, 24U, 4U}, std::array{os2_header, 1U, 3U},
        std::array{108U, 32U, 11U}, std::array{108U, 8U, 12U}}) {
    const std::string file = bmp_file({header, bits, compression, false}, grey, 3, 2);
    EXPECT_THAT(error_of([&] { decode_bitmap("a.bmp", file); }),
                HasSubstr("compressed BMP is not read; save it uncompressed or as PNG"))
        << compression;
  }
  // An embedded picture states 0 bits a pixel.
  EXPECT_THAT(error_of([&] {
                decode_bitmap(
                    "a.bmp",
                    bmp_file({124, 24, 5, false}, grey, 3, 2).replace(28, 2, std::string(2, '\0')));
              }),
              HasSubstr("compressed BMP is not read"));
}

TEST(PictureBmp, MasksOfColoursAreApplied) {
  // 5, 6 and 5 bits after the header of Windows 3: red, green, blue, white.
  std::string file = bmp_file({40, 16, 3, false}, Bytes(4, 0), 4, 1).substr(0, 54);
  for (const std::uint32_t mask : {0xf800U, 0x7e0U, 0x1fU}) append(file, mask);
  file[10] = static_cast<char>(file.size());
  for (const int pixel : {0xf800, 0x7e0, 0x1f, 0xffff})
    append(file, static_cast<std::uint16_t>(pixel));
  EXPECT_EQ(decode_bitmap("a.bmp", file).grey, (Bytes{76, 150, 29, 255}));
  file[54] = 1;  // a gap in the mask of red
  EXPECT_THAT(error_of([&] { decode_bitmap("a.bmp", file); }), HasSubstr("masks"));
}

TEST(PictureBmp, AlphaOfNothingVisibleIsNone) {
  std::string file = bmp_file({40, 32, 0, false}, Bytes{10, 20}, 2, 1);
  file[57] = 0;
  EXPECT_EQ(decode_bitmap("a.bmp", file).alpha, (Bytes{0, 255}));
  file[61] = 0;
  EXPECT_TRUE(decode_bitmap("a.bmp", file).alpha.empty());
  EXPECT_EQ(decode_bitmap("a.bmp", file).grey, (Bytes{10, 20}));
}

}  // namespace
}  // namespace lamplock::picture_bmp_test
