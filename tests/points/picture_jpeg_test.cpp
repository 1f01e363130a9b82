// JPEG whose scans use tables that the file does not define.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "host/model/read_bitmap.hpp"
#include "tests/error_of.hpp"
#include "tests/picture_files.hpp"

namespace lamplock::picture_jpeg_test {
namespace {

using model::decode_bitmap;
using test::error_of;
using ::testing::HasSubstr;

/// Leaves values in memory that the next allocation of the decoder may get.
void fill_heap(int value) {
  constexpr std::size_t decoder_bytes = 20'000;
  std::vector<std::unique_ptr<char[]>> blocks;
  for (std::size_t i = 0; i < 16; ++i) {
    blocks.push_back(std::make_unique<char[]>(decoder_bytes + i * 64));
    std::memset(blocks.back().get(), value, decoder_bytes + i * 64);
  }
}

TEST(PictureJpeg, ScansWithoutTheirTablesAreRefused) {
  const std::vector<int> blocks{0, 40, 80, 120, 160, 200};
  const std::string whole = test::jpeg_of_blocks(3, 2, 1, blocks);
  EXPECT_NO_THROW(decode_bitmap("a.jpg", whole));
  const std::string marker = "\xFF\xC4";
  const std::size_t means = whole.find(marker), rest = whole.find(marker, means + 1);
  for (const std::size_t table : {means, rest}) {
    std::string without = whole;
    // The table gets the number 3; the scan uses 0.
    without[table + 4] = static_cast<char>(without[table + 4] | 3);
    for (const int value : {0, 1, 0x10, 0x7f, 0x80, 0xff}) {
      fill_heap(value);
      EXPECT_THAT(error_of([&] { decode_bitmap("a.jpg", without); }), HasSubstr("damaged"))
          << table << ", " << value;
    }
  }
}

}  // namespace
}  // namespace lamplock::picture_jpeg_test
