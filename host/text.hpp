// Parses text: lines, blanks, numbers, independent of the locale. Called by all readers of text
// files and of a board's lines.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace lamplock {

/// The text without the mark that some editors put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// Removes and returns the next line, without its end: CR, LF or both.
std::string_view take_line(std::string_view& text);

/// The text without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// The whole text as a number; empty if it is not one or does not fit.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace lamplock
