#include "shared/boards/boot2_crc32.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <vector>

namespace lamplock::boards {
namespace {

std::uint32_t crc(std::string_view text) {
  return boot2_crc32(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(Boot2Crc32, KnownVectors) {
  // CRC-32/MPEG-2 in the catalogue of parametrised CRC algorithms.
  EXPECT_EQ(crc("123456789"), 0x0376'e6e7u);
  EXPECT_EQ(crc(""), 0xffff'ffffu);
  EXPECT_EQ(boot2_crc32(std::array<std::uint8_t, 4>{}), 0xc704'dd7bu);
}

}  // namespace
}  // namespace lamplock::boards
