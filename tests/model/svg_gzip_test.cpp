// Compressed SVG drawings (.svgz): the same curves as plain ones; damage is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "host/model/gzip.hpp"
#include "host/model/input.hpp"
#include "tests/model/svg_page.hpp"

namespace lamplock::svg_gzip_test {
namespace {

using test::error_of;
using ::testing::HasSubstr;

std::string gzipped(const std::string& text) {
  z_stream stream{};
  constexpr int gzip_header = 16, memory = 8;
  EXPECT_EQ(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, gzip_header + MAX_WBITS, memory,
                         Z_DEFAULT_STRATEGY),
            Z_OK);
  std::string packed(deflateBound(&stream, text.size()), '\0');
  std::string copy = text;
  stream.next_in = reinterpret_cast<Bytef*>(copy.data());
  stream.avail_in = static_cast<uInt>(copy.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  return packed;
}

class SvgGzip : public test::SvgPage {};

TEST_F(SvgGzip, IsReadAsThePlainDrawing) {
  const std::string page = test::svg_page("<line x2='30'/><circle r='5' cx='50' cy='40'/>");
  const double expected = length(read(page));
  // Under both names; several members are one text.
  EXPECT_DOUBLE_EQ(length(read(gzipped(page))), expected);
  EXPECT_DOUBLE_EQ(length(read(gzipped(page.substr(0, 70)) + gzipped(page.substr(70)))), expected);
  const auto input = model::read_input(folder_.write("a.svgz", gzipped(page)));
  EXPECT_DOUBLE_EQ(length(std::get<model::Curves>(input)), expected);
  const auto plain = model::read_input(folder_.write("b.svgz", page));
  EXPECT_DOUBLE_EQ(length(std::get<model::Curves>(plain)), expected);
}

TEST_F(SvgGzip, DamageIsRefused) {
  const std::string packed = gzipped(test::svg_page("<line x2='30'/>"));
  for (std::size_t size = 3; size < packed.size(); ++size)
    EXPECT_THAT(error_of([&] { model::gunzip("a.svgz", packed.substr(0, size)); }),
                HasSubstr("cut off or damaged"))
        << size;
  EXPECT_THAT(error_of([&] { model::gunzip("a.svgz", packed + "rest"); }),
              HasSubstr("cut off or damaged"));
  std::string wrong = packed;
  wrong[wrong.size() - 6] = static_cast<char>(wrong[wrong.size() - 6] ^ 1);  // CRC
  EXPECT_THAT(error_of([&] { model::gunzip("a.svgz", wrong); }), HasSubstr("cut off or damaged"));
}

TEST_F(SvgGzip, SmallFilesThatUnpackToHugeOnesAreRefused) {
  std::string bomb;
  const std::string member = gzipped(std::string(16u << 20, ' '));
  for (int i = 0; i < 9; ++i) bomb += member;
  EXPECT_THAT(error_of([&] { model::gunzip("a.svgz", bomb); }),
              HasSubstr("unpacks to more than 128 MB"));
}

}  // namespace
}  // namespace lamplock::svg_gzip_test
