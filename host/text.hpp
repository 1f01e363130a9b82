// Text taken apart: lines, blanks, numbers, read the same way whatever the locale. Called by all
// who read files of text or what a board says.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace lamplock {

/// Without the mark that some editors put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// Takes the next line off the front, without its end; CR, LF and both are one.
std::string_view take_line(std::string_view& text);

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// The whole text as a number; nothing if it is not one or does not fit.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace lamplock
