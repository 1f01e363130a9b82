// Lines, fields and numbers of text formats (OBJ, ASCII STL and PLY, point lists), read the same
// way whatever the locale. Called by the readers.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace lamplock::model {

/// Cuts the next line, without its line end (LF or CRLF), off `text`.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// The next line, or nothing at the end of the text.
  std::optional<std::string_view> next();
  /// Number of the line that next() gave last, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Cuts the next field, separated by white space (line ends included), off `text`; empty at the
/// end.
std::string_view next_field(std::string_view& text);

/// The whole field as a number (`nan` and `inf` are numbers); nothing if it is not one or does not
/// fit a double.
std::optional<double> to_double(std::string_view field);

/// The whole field as an integer; nothing if it is not one.
std::optional<long long> to_integer(std::string_view field);

}  // namespace lamplock::model
