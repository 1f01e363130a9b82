// Words of a line of G-code: a letter and a number.
//
// In:  one line as received, without its end.
// Out: its words in sequence, each with the column of its letter.
// Who: the interpreter, at main-loop level; about 20 cycles a character, 90 where separators
//      or very long numbers need the slow way; no division.
//
// Separators are dropped everywhere, inside a number too, as in RS274/NGC ("The NIST RS274/NGC
// Interpreter - Version 3", section 3.3): white space, comments in brackets, all text after a
// semicolon, and as in grbl the slash of block delete. A percent sign (section 3.2) is dropped as
// well. An unclosed bracket makes the rest of the line a comment.
//
// A number is a sign, digits and a point. It is stored as written, a whole number and the number of
// its decimals, until the unit of its command is known: then one product converts it to whole
// multiples of that unit, in inches as well.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/gcode_errors.hpp"

namespace lamplock::program {

/// The error of a line, and the column of the word at fault, 1 for the first character; 0 without
/// an error.
struct Fault {
  GcodeError error = GcodeError::none;
  std::uint16_t column = 0;
  explicit constexpr operator bool() const { return error != GcodeError::none; }
  friend constexpr bool operator==(const Fault&, const Fault&) = default;
};

/// More decimals than these are rounded away, half away from zero.
inline constexpr int max_decimals = 7;
/// Maximum number of digits before the point: numbers are below 10^9.
inline constexpr int max_digits = 9;

/// A letter and its number, mantissa / 10^decimals.
struct Word {
  std::int64_t mantissa;  ///< below 10^(max_digits + max_decimals)
  std::uint16_t column;   ///< of the letter, from 1
  char letter;            ///< upper case; 0 after the last word
  std::uint8_t decimals;  ///< 0..max_decimals
};

/// Number of the word times `factor` times 10^digits, to the nearest whole number, half away from
/// zero. factor: 1 or 254; digits 0..7, with 254 at most 6. Divides only where decimals are lost.
std::int64_t scaled(const Word& word, std::uint32_t factor, int digits);

/// Length in 10^-7 mm of a number in mm or inches.
inline std::int64_t length_e7(const Word& word, bool inches) {
  return inches ? scaled(word, 254, 6) : scaled(word, 1, 7);
}

/// The number as a whole one; not_integer if it has a fraction, negative_value below zero.
GcodeError whole(const Word& word, std::uint32_t& number);

/// Reads the words of a line.
class WordReader {
 public:
  explicit WordReader(std::string_view line) : line_(line) {}
  /// The next word; letter 0 at the end. Errors: letter_expected, bad_number.
  Fault next(Word& word);

  // Text that is not words (power_list.hpp).
  /// The next significant character, 0 at the end; place() is at it.
  char peek();
  /// Removes a character if it is the next one.
  bool take(char c);
  /// A number without a letter; false if there is none.
  bool number(Word& word) { return read_number(word); }
  std::uint16_t place() const { return place_; }
  /// A comment was skipped that may be a message: its text begins with M, D or P.
  bool has_message() const { return has_message_; }
  void go_to(std::uint16_t place) { place_ = place; }

 private:
  void skip_comment();
  bool read_plain_number(Word& word);
  bool read_number(Word& word);

  std::string_view line_;
  std::uint16_t place_ = 0;
  bool has_message_ = false;
};

}  // namespace lamplock::program
