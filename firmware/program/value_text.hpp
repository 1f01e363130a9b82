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

class ValueText {
 public:
  /// Characters of a name.
  static constexpr std::uint32_t max_name = 40;

  void begin(std::string_view line, std::uint16_t index) {
    line_ = line;
    index_ = index;
  }
  /// Of the next character.
  std::uint16_t index() const { return index_; }
  /// A column of the line, from 1: of this index, or the last one.
  std::uint16_t column(std::uint16_t index) const {
    return static_cast<std::uint16_t>(index < line_.size() ? index + 1u : line_.size());
  }
  void go_to(std::uint16_t index) { index_ = index; }

  /// The next character that counts, 0 at the end; index() is at it.
  [[gnu::cold]] char peek();
  /// Takes a character if it is next.
  [[gnu::cold]] bool take(char c);
  /// Takes a word, given in upper case, if it is next in any case.
  [[gnu::cold]] bool take_word(std::string_view text);
  /// A digit or a point is next: takes a number without a sign, rounded to nine decimals.
  /// bad_number: without a digit, or more than nine digits before the point.
  [[gnu::cold]] GcodeError take_number(std::int64_t& e9);
  /// `<` is next: takes a name in angle brackets. bad_expression: empty, or without its end;
  /// no_room: too long.
  [[gnu::cold]] GcodeError take_name();
  /// The name taken last: in lower case, without blanks.
  std::string_view name() const { return {name_.data(), name_size_}; }

 private:
  std::string_view line_;
  std::uint16_t index_ = 0;
  std::uint8_t name_size_ = 0;
  std::array<char, max_name> name_;
};

}  // namespace lamplock::program
