// Readers of pictures: one picture in every form, transparency, orientation, damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <stb/stb_image_write.h>

#include <random>

#include "host/file.hpp"
#include "host/model/picture.hpp"
#include "host/model/read_bitmap.hpp"
#include "tests/damaged.hpp"
#include "tests/error_of.hpp"
#include "tests/picture_files.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock {
namespace {

using model::Bitmap;
using model::decode_bitmap;
using model::read_bitmap;
using test::error_of;
using test::png_chunk;
using test::png_file;
using test::PngType;
using test::TemporaryFolder;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Samples = std::vector<std::uint32_t>;

/// Written by another library than the reader's.
std::string png_of(unsigned width, unsigned height, const Bytes& rgba,
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

TEST(ReadBitmap, PngIsGreyAndAlpha) {
  const TemporaryFolder folder;
  const Bytes rgba{0, 0, 0, 255, 255, 255, 255, 255, 0,  0,  0,  0,
                   0, 0, 0, 128, 255, 0,   0,   255, 50, 50, 50, 255};
  const Bitmap bitmap = read_bitmap(folder.write("a.png", png_of(3, 2, rgba, folder)));
  EXPECT_EQ(bitmap.width, 3);
  EXPECT_EQ(bitmap.height, 2);
  EXPECT_EQ(bitmap.grey, (Bytes{0, 255, 0, 0, 76, 50}));
  EXPECT_EQ(bitmap.alpha, (Bytes{255, 255, 0, 128, 255, 255}));
  EXPECT_EQ(model::flattened(bitmap, model::white).grey, (Bytes{0, 255, 255, 127, 76, 50}));
  EXPECT_EQ(model::flattened(bitmap, model::black).grey, (Bytes{0, 255, 0, 0, 76, 50}));
}

/// A JPEG of the highest quality.
std::string jpeg_of(int width, int height, const Bytes& grey) {
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
  Bytes grey;
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
  EXPECT_EQ(bitmap.grey, (Bytes{0, 255, 100, 255}));
}

TEST(ReadBitmap, TruncatedAndForeignFilesAreRefused) {
  const TemporaryFolder folder;
  std::mt19937_64 random(3);
  Bytes rgba(40 * 30 * 4);
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

TEST(ReadBitmap, OtherFormatsAreNamedByTheirContent) {
  const TemporaryFolder folder;
  for (const auto& [bytes, name] : {std::pair{std::string("GIF89a\1\0\1\0\0\0\0;", 14), "GIF"},
                                    std::pair{std::string("II*\0\x08\0\0\0", 8), "TIFF"},
                                    std::pair{std::string("MM\0*\0\0\0\x08", 8), "TIFF"},
                                    std::pair{std::string("RIFF\x1a\0\0\0WEBPVP8 ", 16), "WebP"},
                                    std::pair{std::string("\0\0\0\x18"
                                                          "ftypheic",
                                                          12),
                                              "HEIC"}}) {
    for (const char* file : {"a.png", "a.jpg", "a.bmp"}) {
      const auto path = folder.write(file, bytes);
      EXPECT_THAT(error_of([&] { read_bitmap(path); }),
                  testing::AllOf(HasSubstr(name), HasSubstr("convert it to PNG")));
    }
    const std::string start = bytes.substr(0, 3);
    EXPECT_THAT(error_of([&] { decode_bitmap("a.png", start); }),
                HasSubstr("is not a PNG, BMP or JPEG"));
  }
}

/// The greys of one picture of 5 x 3.
const Samples greys{0, 255, 17, 68, 136, 255, 51, 0, 204, 34, 102, 187, 255, 0, 221};

/// The same picture in every depth that holds its greys.
std::vector<std::pair<std::string, std::string>> every_form() {
  std::vector<std::pair<std::string, std::string>> forms;
  Samples four, sixteen, rgb, rgb16, index, alpha, alpha16, rgba, rgba16;
  std::string palette;
  for (const std::uint32_t grey : greys) {
    four.push_back(grey / 17);
    sixteen.push_back(grey * 257);
    index.push_back(static_cast<std::uint32_t>(palette.size() / 3));
    palette += std::string(3, static_cast<char>(grey));
    for (int i = 0; i < 3; ++i) {
      rgb.push_back(grey);
      rgb16.push_back(grey * 257);
      rgba.push_back(grey);
      rgba16.push_back(grey * 257);
    }
    rgba.push_back(255);
    rgba16.push_back(65'535);
    alpha.insert(alpha.end(), {grey, 255});
    alpha16.insert(alpha16.end(), {grey * 257, 65'535});
  }
  forms.emplace_back("grey 4", png_file(5, 3, 4, PngType::grey, four));
  forms.emplace_back("grey 8", png_file(5, 3, 8, PngType::grey, greys));
  forms.emplace_back("grey 16", png_file(5, 3, 16, PngType::grey, sixteen));
  forms.emplace_back("rgb 8", png_file(5, 3, 8, PngType::rgb, rgb));
  forms.emplace_back("rgb 16", png_file(5, 3, 16, PngType::rgb, rgb16));
  for (const int depth : {4, 8})
    forms.emplace_back("palette",
                       png_file(5, 3, depth, PngType::palette, index, png_chunk("PLTE", palette)));
  forms.emplace_back("grey alpha 8", png_file(5, 3, 8, PngType::grey_alpha, alpha));
  forms.emplace_back("grey alpha 16", png_file(5, 3, 16, PngType::grey_alpha, alpha16));
  forms.emplace_back("rgb alpha 8", png_file(5, 3, 8, PngType::rgb_alpha, rgba));
  forms.emplace_back("rgb alpha 16", png_file(5, 3, 16, PngType::rgb_alpha, rgba16));
  // A gamma must not change the greys of some forms and not those of others.
  forms.emplace_back("gamma", png_file(5, 3, 16, PngType::grey, sixteen,
                                       png_chunk("gAMA", test::big_endian(100'000, 4))));
  return forms;
}

TEST(ReadBitmap, EveryDepthIsTheSamePicture) {
  for (const auto& [name, bytes] : every_form()) {
    const Bitmap bitmap = decode_bitmap("a.png", bytes);
    EXPECT_EQ(bitmap.width, 5) << name;
    EXPECT_EQ(bitmap.grey, Bytes(greys.begin(), greys.end())) << name;
    EXPECT_TRUE(bitmap.alpha.empty()) << name;
  }
}

TEST(ReadBitmap, EveryTransparencyIsAlpha) {
  const auto alpha_of = [](const std::string& bytes) {
    return decode_bitmap("a.png", bytes).alpha;
  };
  const std::string palette = png_chunk("PLTE", std::string("\0\0\0\xFF\xFF\xFF\x80\x80\x80", 9));
  EXPECT_EQ(alpha_of(png_file(3, 1, 2, PngType::palette, {0, 1, 2},
                              palette + png_chunk("tRNS", std::string("\0\x64", 2)))),
            (Bytes{0, 100, 255}));
  EXPECT_EQ(alpha_of(png_file(3, 1, 8, PngType::grey, {7, 8, 9},
                              png_chunk("tRNS", test::big_endian(8, 2)))),
            (Bytes{255, 0, 255}));
  // A transparent colour is compared with all its bits.
  EXPECT_EQ(alpha_of(png_file(3, 1, 16, PngType::grey, {0x1200, 0x1201, 0x1202},
                              png_chunk("tRNS", test::big_endian(0x1201, 2)))),
            (Bytes{255, 0, 255}));
  EXPECT_EQ(
      alpha_of(png_file(2, 1, 8, PngType::rgb, {1, 2, 3, 1, 2, 4},
                        png_chunk("tRNS", test::big_endian(0x10002, 4) + std::string("\0\3", 2)))),
      (Bytes{0, 255}));
  EXPECT_EQ(alpha_of(png_file(2, 1, 16, PngType::grey_alpha, {65'535, 0, 0, 32'896})),
            (Bytes{0, 128}));
}

/// Two greys for each block of 3 x 2, so that every orientation differs.
const std::vector<int> blocks{0, 40, 80, 120, 160, 200};

/// What a camera with this orientation stores of an upright picture of 3 x 2 blocks, by the table
/// "where row 0 and column 0 are" of Exif.
std::vector<int> stored_blocks(int orientation) {
  constexpr int width = 3, height = 2;
  const bool sides_change = orientation >= 5;
  const int columns = sides_change ? height : width, rows = sides_change ? width : height;
  // The first row is at the top, bottom, left or right; the first column likewise.
  const std::array<std::array<bool, 2>, 9> reversed{{{},
                                                     {false, false},
                                                     {false, true},
                                                     {true, true},
                                                     {true, false},
                                                     {false, false},
                                                     {true, false},
                                                     {true, true},
                                                     {false, true}}};
  const auto [row_reversed, column_reversed] = reversed[static_cast<std::size_t>(orientation)];
  std::vector<int> stored;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int r = row_reversed ? rows - 1 - row : row;
      const int c = column_reversed ? columns - 1 - column : column;
      const int x = sides_change ? r : c, y = sides_change ? c : r;
      stored.push_back(blocks[static_cast<std::size_t>(y * width + x)]);
    }
  }
  return stored;
}

TEST(ReadBitmap, EveryOrientationIsOnePicture) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const std::vector<int> stored = stored_blocks(orientation);
    const int columns = orientation >= 5 ? 2 : 3, rows = 5 - columns;
    for (const bool big : {false, true}) {
      const Bitmap jpeg = decode_bitmap(
          "a.jpg",
          test::jpeg_of_blocks(columns, rows, 1, stored, test::jpeg_exif(orientation, big)));
      ASSERT_EQ(jpeg.width, 24) << orientation;
      ASSERT_EQ(jpeg.height, 16) << orientation;
      for (std::size_t i = 0; i < jpeg.grey.size(); ++i)
        ASSERT_NEAR(jpeg.grey[i], blocks[i / 24 / 8 * 3 + i % 24 / 8], 1) << orientation;
      const Bitmap png = decode_bitmap(
          "a.png", png_file(columns, rows, 8, PngType::grey, Samples(stored.begin(), stored.end()),
                            png_chunk("eXIf", test::exif_block(orientation, big))));
      EXPECT_EQ(png.grey, Bytes(blocks.begin(), blocks.end())) << orientation;
    }
  }
  // A camera without the tag, and one that writes nonsense.
  for (const int orientation : {0, 9, 65'535})
    EXPECT_EQ(
        decode_bitmap("a.jpg", test::jpeg_of_blocks(3, 2, 1, blocks, test::jpeg_exif(orientation)))
            .width,
        24);
}

TEST(ReadBitmap, CmykIsReadAsItLooks) {
  // As Adobe writes it, 255 is no ink: white, black by K, black by all inks, cyan, half of K.
  const std::vector<int> inks{255, 255, 255, 255, 255, 255, 255, 0,   0,   0,
                              0,   255, 0,   255, 255, 255, 255, 255, 255, 128};
  const Bitmap bitmap =
      decode_bitmap("a.jpg", test::jpeg_of_blocks(5, 1, 4, inks, test::jpeg_adobe(0)));
  const std::array<int, 5> expected{255, 0, 0, 179, 128};
  for (std::size_t i = 0; i < bitmap.grey.size(); ++i)
    ASSERT_NEAR(bitmap.grey[i], expected[i % 40 / 8], 2) << i % 40;
  EXPECT_THAT(error_of([&] { decode_bitmap("a.jpg", test::jpeg_of_blocks(5, 1, 4, inks)); }),
              HasSubstr("convert it to RGB"));
}

TEST(ReadBitmap, PhotosDifferFromDrawings) {
  std::mt19937_64 random(1);
  Bitmap photo{64, 64, {}}, drawing{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    photo.grey.push_back(static_cast<std::uint8_t>(i % 64 * 4));
    const bool edge = i % 10 == 0;
    drawing.grey.push_back(edge ? static_cast<std::uint8_t>(random()) : i % 3 == 0 ? 0 : 255);
  }
  EXPECT_TRUE(model::is_photo(photo));
  EXPECT_FALSE(model::is_photo(drawing));
  photo.alpha.assign(64 * 64, 0);
  EXPECT_FALSE(model::is_photo(photo));
}

TEST(ReadBitmap, EveryFlippedBitOfAPngIsRefused) {
  const std::string whole = png_file(3, 2, 8, PngType::palette, {0, 1, 0, 1, 0, 1},
                                     png_chunk("tEXt", std::string("Title\0abc", 9)) +
                                         png_chunk("PLTE", std::string("\0\0\0\xFF\xFF\xFF", 6)));
  EXPECT_EQ(decode_bitmap("a.png", whole).grey, (Bytes{0, 255, 0, 255, 0, 255}));
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string bytes = whole;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_NE(error_of([&] { decode_bitmap("a.png", bytes); }), "") << bit / 8;
  }
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(error_of([&] { decode_bitmap("a.png", whole.substr(0, size)); }), "") << size;
  EXPECT_THAT(error_of([&] { decode_bitmap("a.png", whole + '\0'); }), HasSubstr("after its end"));
}

TEST(ReadBitmap, SizesThatAFileCannotHoldAreRefused) {
  const auto png = [](std::uint32_t width, std::uint32_t height) {
    const std::string whole = png_file(2, 2, 8, PngType::grey, {1, 2, 3, 4});
    constexpr std::size_t header = 8, after_header = 33, settings = 24;
    return whole.substr(0, header) +
           png_chunk("IHDR", test::big_endian(width, 4) + test::big_endian(height, 4) +
                                 whole.substr(settings, 5)) +
           whole.substr(after_header);
  };
  EXPECT_EQ(decode_bitmap("a.png", png(2, 2)).grey.size(), 4u);
  EXPECT_THAT(error_of([&] { decode_bitmap("a.png", png(10'000, 10'000)); }), HasSubstr("cut off"));
  EXPECT_THAT(error_of([&] { decode_bitmap("a.png", png(2'000'000'000, 2'000'000'000)); }),
              HasSubstr("has 2000000000 x 2000000000 pixels"));
  EXPECT_NE(error_of([&] { decode_bitmap("a.png", png(0, 2)); }), "");
  std::string jpeg = test::jpeg_of_blocks(3, 2, 1, blocks);
  const std::size_t frame = jpeg.find("\xFF\xC0");
  jpeg.replace(frame + 5, 4, "\x27\x10\x27\x10");
  EXPECT_THAT(error_of([&] { decode_bitmap("a.jpg", jpeg); }), HasSubstr("cut off"));
  jpeg.replace(frame + 5, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_THAT(error_of([&] { decode_bitmap("a.jpg", jpeg); }), HasSubstr("65535 x 65535"));
  // A scan of a few bytes takes the time of the whole picture.
  jpeg = test::jpeg_of_blocks(3, 2, 1, blocks);
  const std::size_t scan = jpeg.find("\xFF\xDA");
  const std::string one = jpeg.substr(scan, jpeg.size() - 2 - scan);
  std::string many = jpeg.substr(0, scan);
  for (int i = 0; i < 200; ++i) many += one;
  EXPECT_THAT(error_of([&] { decode_bitmap("a.jpg", many + "\xFF\xD9"); }),
              HasSubstr("too many scans"));
}

void expect_whole(const Bitmap& bitmap) {
  const auto pixels =
      static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
  EXPECT_EQ(bitmap.grey.size(), pixels);
  EXPECT_TRUE(bitmap.alpha.empty() || bitmap.alpha.size() == pixels);
}

/// Mutated files of one picture; at a scale of 20 there are 10 000.
void expect_mutations_read_or_refused(const std::string& whole) {
  EXPECT_NO_THROW(expect_whole(decode_bitmap("a.png", whole)));
  test::expect_damaged_read_or_refused(
      test::scaled(500), whole, test::any_byte(),
      [](const std::string& bytes) { expect_whole(decode_bitmap("a.png", bytes)); });
}

/// The chunks of a damaged PNG with right checksums and, where possible, lengths, so that the
/// damage reaches the library.
std::string with_checksums(std::string bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const auto* length_at = reinterpret_cast<const std::uint8_t*>(bytes.data() + at);
    std::size_t length = 0;
    for (int i = 0; i < 4; ++i) length = length << 8 | length_at[i];
    if (length > bytes.size() - at - 12) length = bytes.size() - at - 12;
    bytes.replace(at, 4, test::big_endian(static_cast<std::uint32_t>(length), 4));
    const std::string_view sum_of = std::string_view(bytes).substr(at + 4, 4 + length);
    bytes.replace(at + 8 + length, 4, test::big_endian(test::png_crc(sum_of), 4));
    at += 12 + length;
  }
  return bytes;
}

TEST(ReadBitmap, DamagedPngAtWorstFails) {
  const TemporaryFolder folder;
  Bytes rgba;
  for (int i = 0; i < 24 * 16 * 4; ++i) rgba.push_back(static_cast<std::uint8_t>(i * i));
  const std::string packed = png_of(24, 16, rgba, folder);
  const std::string palette = png_file(3, 2, 8, PngType::palette, {0, 1, 0, 1, 0, 1},
                                       png_chunk("PLTE", std::string("\0\0\0\xFF\xFF\xFF", 6)) +
                                           png_chunk("tRNS", std::string("\0\x80", 2)) +
                                           png_chunk("eXIf", test::exif_block(6)));
  expect_mutations_read_or_refused(packed);
  for (const std::string& whole : {packed, palette}) {
    int read = 0;
    test::expect_damaged_read_or_refused(
        test::scaled(500), whole, test::any_byte(), [&read](const std::string& bytes) {
          expect_whole(decode_bitmap("a.png", with_checksums(bytes)));
          ++read;
        });
    EXPECT_GT(read, 0);  // the mutations get past the checksums
  }
}

TEST(ReadBitmap, DamagedJpegAtWorstFails) {
  Bytes grey;
  for (int i = 0; i < 32 * 24; ++i) grey.push_back(static_cast<std::uint8_t>(i * i));
  expect_mutations_read_or_refused(jpeg_of(32, 24, grey));
  expect_mutations_read_or_refused(test::jpeg_of_blocks(3, 2, 1, blocks, test::jpeg_exif(6)));
  std::vector<int> inks(24, 99);
  expect_mutations_read_or_refused(
      test::jpeg_of_blocks(3, 2, 4, inks, test::jpeg_adobe(0) + test::jpeg_exif(5, false)));
}

TEST(ReadBitmap, DamagedBmpAtWorstFails) { expect_mutations_read_or_refused(small_bmp()); }

}  // namespace
}  // namespace lamplock
