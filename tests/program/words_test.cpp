// Words: what is a word, its number, and the column of an error.
#include "shared/gcode_words.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <random>
#include <string>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::words_test {
namespace {

using lamplock::test::scaled;
using test::text_of;
using Integer = boost::multiprecision::cpp_int;

/// "X12.5@1 Y-3@7", or ending with a fault.
std::string words_of(std::string_view line) {
  WordReader reader(line);
  std::string text;
  for (;;) {
    Word word;
    const Fault fault = reader.next(word);
    if (!fault && word.letter == 0) return text;
    if (!text.empty()) text += ' ';
    if (fault) return text + "error " + text_of(fault);
    text += word.letter + test::decimal(program::scaled(word, 1, 7)) + "@" +
            std::to_string(word.column);
  }
}

TEST(Words, OfLines) {
  const test::Row rows[] = {
      {"", ""},
      {"   \t", ""},
      {"G1X12.345Y-6.789", "G1@1 X12.345@3 Y-6.789@10"},
      {"g1 x12.345 y-6.789", "G1@1 X12.345@4 Y-6.789@12"},
      {"G 1 X 1 2 . 5 Y - 3", "G1@1 X12.5@5 Y-3@15"},
      {"X1(a comment; Y3)2", "X12@1"},
      {"(only a comment)", ""},
      {"X1 (not closed Y2", "X1@1"},
      {"X1 ; Y2", "X1@1"},
      {"X1;(Y2)", "X1@1"},
      {"/X1 Y2", "X1@2 Y2@5"},
      {"%", ""},
      {"%X1", "X1@2"},
      {"X+1", "X1@1"},
      {"X.5", "X0.5@1"},
      {"X5.", "X5@1"},
      {"X-.5", "X-0.5@1"},
      {"X0000000000000000001", "X1@1"},
      {"X0.1234567", "X0.1234567@1"},
      {"X0.12345674", "X0.1234567@1"},
      {"X0.12345675", "X0.1234568@1"},
      {"X-0.12345675", "X-0.1234568@1"},
      {"X0.12345674999999999999", "X0.1234567@1"},
      {"X0.99999995", "X1@1"},
      {"X999999999.9999999", "X999999999.9999999@1"},
      {"X1000000000", "error 2@1"},
      {"Y1X1000000000.0", "Y1@1 error 2@3"},
      {"X", "error 2@1"},
      {" X-", "error 2@2"},
      {"X.", "error 2@1"},
      {"X+-1", "error 2@1"},
      {"X--1", "error 2@1"},
      {"XY1", "error 2@1"},
      {"X1.2.3", "X1.2@1 error 1@5"},
      {"1", "error 1@1"},
      {"X1 #5", "X1@1 error 1@4"},
      {"X1 )", "X1@1 error 1@4"},
      {"X1-2", "X1@1 error 1@3"},
      {"X1\xc3\xa4", "X1@1 error 1@3"},
      {"*", "error 1@1"},
  };
  for (const test::Row& row : rows) EXPECT_EQ(words_of(row.lines), row.wanted) << row.lines;
}

Word first_word(const std::string& line) {
  WordReader reader(line);
  Word word{};
  EXPECT_FALSE(reader.next(word)) << line;
  return word;
}

/// value / divisor to the nearest whole number, half away from zero.
Integer nearest(const Integer& value, const Integer& divisor) {
  const Integer n = (2 * abs(value) + divisor) / (2 * divisor);
  return value < 0 ? Integer(-n) : n;
}

TEST(Words, NumbersAreRoundedOnceHalfAwayFromZero) {
  std::mt19937_64 random(1);
  for (int i = 0; i < scaled(3000); ++i) {
    std::string digits = std::to_string(random() % 1'000'000'000 >> random() % 30);
    std::string text = digits + ".";
    Integer mantissa(digits), unit = 1;
    for (auto decimals = random() % 8; decimals > 0; --decimals) {
      const auto digit = random() % 2 == 0 ? 5 * (random() % 2) : random() % 10;
      text += static_cast<char>('0' + digit);
      mantissa = mantissa * 10 + digit;
      unit *= 10;
    }
    const bool negative = random() % 2 == 0;
    if (negative) mantissa = -mantissa;
    const Word word = first_word((negative ? "X-" : "X") + text);
    Integer wanted = mantissa;
    for (int to = 0; to <= 7; ++to) {
      EXPECT_EQ(program::scaled(word, 1, to), nearest(wanted, unit)) << text;
      if (to < 7) {
        EXPECT_EQ(program::scaled(word, 254, to), nearest(wanted * 254, unit)) << text;
      }
      wanted *= 10;
    }
    EXPECT_EQ(length_e7(word, true), nearest(mantissa * 254'000'000, unit)) << text;
  }
}

TEST(Words, WholeNumbers) {
  std::uint32_t number = 7;
  EXPECT_EQ(whole(first_word("P3"), number), GcodeError::none);
  EXPECT_EQ(number, 3u);
  EXPECT_EQ(whole(first_word("P12.000"), number), GcodeError::none);
  EXPECT_EQ(number, 12u);
  EXPECT_EQ(whole(first_word("P999999999"), number), GcodeError::none);
  EXPECT_EQ(number, 999'999'999u);
  EXPECT_EQ(whole(first_word("P0.5"), number), GcodeError::not_integer);
  EXPECT_EQ(whole(first_word("P-0.5"), number), GcodeError::not_integer);
  EXPECT_EQ(whole(first_word("P-1"), number), GcodeError::negative_value);
  EXPECT_EQ(whole(first_word("P1.0000001"), number), GcodeError::not_integer);
}

}  // namespace
}  // namespace lamplock::program::words_test
