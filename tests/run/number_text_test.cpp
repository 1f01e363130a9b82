// Numbers and counts in messages.
#include "host/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "tests/scale.hpp"

namespace lamplock::number_text_test {
namespace {

TEST(NumberText, HasNoExponentsAndNoRoundingErrors) {
  EXPECT_EQ(number_text(10000), "10000");
  EXPECT_EQ(number_text(7.105e-15), "0");
  EXPECT_EQ(number_text(-1e-9), "0");
  EXPECT_EQ(number_text(0.25), "0.25");
  EXPECT_EQ(number_text(-12.5), "-12.5");
  EXPECT_EQ(number_text(100.04), "100");
  EXPECT_EQ(number_text(100.04, 5), "100.04");
  EXPECT_EQ(number_text(123456.7), "123457");
  EXPECT_EQ(number_text(0.00012361), "0.0001236");
  std::mt19937 random(2);
  std::uniform_real_distribution<double> exponent(-5, 8), mantissa(-1, 1);
  for (int i = 0; i < test::scaled(2000); ++i) {
    const double value = mantissa(random) * std::pow(10, exponent(random));
    const std::string text = number_text(value);
    EXPECT_EQ(text.find('e'), std::string::npos) << text;
    EXPECT_NEAR(std::strtod(text.c_str(), nullptr), value, std::abs(value) * 5.1e-4 + 1e-6);
  }
}

TEST(CountText, AgreesWithItsNumber) {
  EXPECT_EQ(count_text(0, "point"), "0 points");
  EXPECT_EQ(count_text(1, "point"), "1 point");
  EXPECT_EQ(count_text(2, "vertex", "vertices"), "2 vertices");
}

}  // namespace
}  // namespace lamplock::number_text_test
