// Lines, fields and numbers of text formats (OBJ, ASCII STL and PLY, point lists), independent of
// the locale. Called by the readers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::model {

/// The lines of a text without its byte-order mark. They end with LF or CRLF, in a text without any
/// LF with CR.
class Lines {
 public:
  explicit Lines(std::string_view text);
  /// The next line; empty at the end of the text.
  std::optional<std::string_view> next();
  /// Number of the line that next() returned last, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  char line_end_;
  std::size_t number_ = 0;
};

/// Removes the next field, separated by white space (line ends included), from `text`; empty at the
/// end.
std::string_view next_field(std::string_view& text);

/// The whole field as a number (`nan` and `inf` are numbers); empty if it is not one or does not
/// fit a double.
std::optional<double> to_double(std::string_view field);

/// True if a comma is between two digits, as in numbers with decimal commas.
bool has_decimal_comma(std::string_view text);
/// The remedy for such numbers.
inline constexpr const char* write_decimal_points = "write decimal points: 1.5 instead of 1,5";

/// The whole field as an integer; empty if it is not one.
std::optional<long long> to_integer(std::string_view field);

}  // namespace lamplock::model
