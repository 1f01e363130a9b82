// Interlaced PNG: every colour type and depth is the same picture with and without interlace.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "tests/picture_files.hpp"

namespace lamplock::picture_interlace_test {
namespace {

using model::Bitmap;
using model::decode_bitmap;
using test::big_endian;
using test::png_chunk;
using test::png_file;
using test::PngInterlace;
using test::PngType;

using Samples = std::vector<std::uint32_t>;

struct Form {
  PngType type;
  int depth;
};

constexpr std::array forms{
    Form{PngType::grey, 1},        Form{PngType::grey, 2},      Form{PngType::grey, 4},
    Form{PngType::grey, 8},        Form{PngType::grey, 16},     Form{PngType::rgb, 8},
    Form{PngType::rgb, 16},        Form{PngType::palette, 1},   Form{PngType::palette, 2},
    Form{PngType::palette, 4},     Form{PngType::palette, 8},   Form{PngType::grey_alpha, 8},
    Form{PngType::grey_alpha, 16}, Form{PngType::rgb_alpha, 8}, Form{PngType::rgb_alpha, 16}};

int samples_of(PngType type) {
  switch (type) {
    case PngType::rgb:
      return 3;
    case PngType::grey_alpha:
      return 2;
    case PngType::rgb_alpha:
      return 4;
    case PngType::grey:
    case PngType::palette:
      return 1;
  }
  return 0;
}

/// The palette, if the type has one, and transparency where a chunk defines it.
std::string chunks_of(const Form& form, const Samples& samples) {
  std::string colours;
  switch (form.type) {
    case PngType::palette:
      for (int i = 0; i < 1 << form.depth; ++i)
        for (const int factor : {17, 29, 101}) colours += static_cast<char>(i * factor);
      return png_chunk("PLTE", colours) + png_chunk("tRNS", "\x20\x90");
    case PngType::grey:
      return png_chunk("tRNS", big_endian(samples[0], 2));
    case PngType::rgb:
      return png_chunk("tRNS", big_endian(samples[0], 2) + big_endian(samples[1], 2) +
                                   big_endian(samples[2], 2));
    case PngType::grey_alpha:
    case PngType::rgb_alpha:
      return "";
  }
  return "";
}

/// 16 bits rounded to 8.
std::uint8_t rounded(std::uint32_t sample, int depth) {
  const std::uint32_t max = (1U << depth) - 1;
  return static_cast<std::uint8_t>((sample * 255ULL * 2 + max) / (2ULL * max));
}

TEST(PictureInterlace, EveryTypeAndDepthIsTheSamePicture) {
  std::mt19937 random(5);
  for (const Form& form : forms) {
    for (const auto& [width, height] : {std::array{1, 1}, std::array{3, 2}, std::array{5, 9},
                                        std::array{13, 8}, std::array{33, 17}}) {
      SCOPED_TRACE(testing::Message() << "type " << static_cast<int>(form.type) << ", "
                                      << form.depth << " bits, " << width << " x " << height);
      Samples samples(static_cast<std::size_t>(width * height * samples_of(form.type)));
      for (auto& sample : samples)
        sample = static_cast<std::uint32_t>(random()) & ((1U << form.depth) - 1);
      const std::string chunks = chunks_of(form, samples);
      const Bitmap plain =
          decode_bitmap("a.png", png_file(width, height, form.depth, form.type, samples, chunks));
      const Bitmap interlaced = decode_bitmap(
          "a.png",
          png_file(width, height, form.depth, form.type, samples, chunks, PngInterlace::adam7));
      EXPECT_EQ(interlaced.width, width);
      EXPECT_EQ(interlaced.height, height);
      EXPECT_EQ(interlaced.grey, plain.grey);
      EXPECT_EQ(interlaced.alpha, plain.alpha);
      // An oracle for the types without a palette or colours.
      const int per_pixel = samples_of(form.type);
      if (form.type != PngType::grey && form.type != PngType::grey_alpha) continue;
      for (std::size_t i = 0; i < plain.grey.size(); ++i)
        EXPECT_EQ(interlaced.grey[i],
                  rounded(samples[i * static_cast<std::size_t>(per_pixel)], form.depth));
    }
  }
}

}  // namespace
}  // namespace lamplock::picture_interlace_test
