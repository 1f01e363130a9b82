// The text of values in a line: characters, words, numbers and names of parameters.
//
// In:  a line and an index in it. Out: what is next there.
// Who: expressions (expression.hpp), main loop.
//
// Blanks and comments count nowhere, in a number neither. Unlike between the words of a line
// (shared/gcode_words.hpp) a slash counts.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "shared/gcode_errors.hpp"

namespace lamplock::program {

/// Up to six letters in any case as one number, to compare with those of a table; 0 without any.
using Letters = std::uint32_t;
inline constexpr int max_letters = 6;
constexpr bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
/// The letters and one more.
constexpr Letters with_letter(Letters letters, char c) {
  return letters << 5 | (static_cast<unsigned char>(c) & 31u);
}
consteval Letters letters_of(std::string_view text) {
  Letters letters = 0;
  for (const char c : text) letters = with_letter(letters, c);
  return letters;
}

class ValueText {
 public:
  /// Characters of a name.
  static constexpr std::uint32_t max_name = 40;

  [[gnu::cold]] void begin(std::string_view line, std::uint16_t index) {
    line_ = line;
    go_to(index);
  }
  /// Of the next character that counts.
  std::uint16_t index() const { return index_; }
  /// A column of the line, from 1: of this index, or the last one.
  std::uint16_t column(std::uint16_t index) const {
    return static_cast<std::uint16_t>(index < line_.size() ? index + 1u : line_.size());
  }
  [[gnu::cold]] void go_to(std::uint16_t index);

  /// The next character that counts, 0 at the end; index() is at it.
  char peek() const { return next_; }
  /// Takes a character if it is next.
  [[gnu::cold]] bool take(char c);
  /// Takes all letters that are next, at most `count` of them, at most six.
  [[gnu::cold]] Letters take_letters(int count = max_letters);
  /// A digit or a point is next: takes a number without a sign, rounded to nine decimals.
  /// bad_number: without a digit, or more than nine digits before the point.
  [[gnu::cold]] GcodeError take_number(std::int64_t& e9);
  /// Takes a number if it is next and has no point and less than ten digits.
  [[gnu::cold]] bool take_whole(std::uint32_t& number);
  /// `<` is next: takes a name in angle brackets. bad_expression: empty, or without its end;
  /// no_room: too long.
  [[gnu::cold]] GcodeError take_name();
  /// The name taken last: in lower case, without blanks.
  std::string_view name() const { return {name_.data(), name_size_}; }

 private:
  [[gnu::cold]] void advance();

  std::string_view line_;
  std::uint16_t index_ = 0;
  char next_ = 0;
  std::uint8_t name_size_ = 0;
  std::array<char, max_name> name_;
};

}  // namespace lamplock::program
