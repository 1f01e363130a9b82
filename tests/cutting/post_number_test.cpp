// Numbers of programs are rounded to their decimals, without trailing zeros and "-0".
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/cutting/post_template.hpp"

namespace lamplock::test::post_number_test {
namespace {

using cutting::post_number;

TEST(PostNumber, HasTheShortestText) {
  EXPECT_EQ(post_number(0, 4), "0");
  EXPECT_EQ(post_number(-0.00001, 4), "0");
  EXPECT_EQ(post_number(-0.0001, 4), "-0.0001");
  EXPECT_EQ(post_number(12.5, 4), "12.5");
  EXPECT_EQ(post_number(-100, 3), "-100");
  EXPECT_EQ(post_number(1200.04, 2), "1200.04");
  EXPECT_EQ(post_number(7, 0), "7");
  EXPECT_EQ(post_number(1e20, 3), "100000000000000000000");
}

TEST(PostNumber, IsTheRoundedNumber) {
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    const int decimals = static_cast<int>(random() % 8);
    const double size = std::pow(10, static_cast<double>(random() % 9) - 4);
    const double scale = std::pow(10, decimals);
    const double value =
        std::round(std::uniform_real_distribution(-size, size)(random) * scale) / scale;
    const std::string text = post_number(value, decimals);
    EXPECT_EQ(std::stod(text), value == 0 ? 0 : value) << text;
    EXPECT_LE(text.size(), fmt::format("{:.{}f}", value, decimals).size());
  }
}

}  // namespace
}  // namespace lamplock::test::post_number_test
