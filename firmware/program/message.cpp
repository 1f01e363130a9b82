#include "firmware/program/message.hpp"

namespace lamplock::program {
namespace {

constexpr int digits_of_e9 = 9;
constexpr int default_decimals = 6, decimals_of_f = 4;

constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// At most this many characters. Not substr(), which may throw.
constexpr std::string_view front_of(std::string_view text, std::size_t most) {
  return {text.data(), text.size() < most ? text.size() : most};
}

/// The index of the next `a` or `b`, the size if there is none. Not find(), which calls memchr.
constexpr std::size_t index_of(std::string_view text, char a, char b) {
  std::size_t i = 0;
  while (i < text.size() && text[i] != a && text[i] != b) ++i;
  return i;
}

void drop_blanks(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
}

/// Removes a word in capitals from the front, in any case.
bool take_word(std::string_view& text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (upper(text[i]) != word[i]) return false;
  text.remove_prefix(word.size());
  return true;
}

/// Decimals for the values after a format, which is removed from the front; false if it is none.
bool take_format(std::string_view& text, int& decimals) {
  std::string_view rest = text;
  rest.remove_prefix(1);
  if (take_word(rest, "D"))
    decimals = 0;
  else if (take_word(rest, "F"))
    decimals = decimals_of_f;
  else if (take_word(rest, "LF"))
    decimals = default_decimals;
  else if (rest.size() >= 3 && rest[0] == '.' && rest[1] >= '0' && rest[1] <= '9' &&
           upper(rest[2]) == 'F') {
    decimals = rest[1] - '0';
    rest.remove_prefix(3);
  } else
    return false;
  text = rest;
  return true;
}

/// The text of the parameter at the front; empty if there is none.
std::string_view parameter_at(std::string_view text) {
  std::size_t end = 1;
  if (text.size() > 1 && text[1] == '<') {
    const std::size_t close = index_of(text, '>', '>');
    return close == text.size() ? std::string_view{} : front_of(text, close + 1);
  }
  while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
  return end == 1 ? std::string_view{} : front_of(text, end);
}

/// Rounded, half to even, as printf does.
void add_value(TextLine& text, std::int64_t e9, int decimals) {
  if (e9 < 0) text.add("-");
  const auto magnitude = static_cast<std::uint64_t>(e9 < 0 ? -e9 : e9);
  std::uint64_t unit = 1, scale = 1;
  for (int i = decimals; i < digits_of_e9; ++i) unit *= 10;
  for (int i = 0; i < decimals; ++i) scale *= 10;
  const std::uint64_t below = magnitude / unit, rest_e9 = magnitude % unit * 2;
  const bool up = rest_e9 > unit || (rest_e9 == unit && below % 2 != 0);
  const std::uint64_t value = below + (up ? 1 : 0);
  text.add(static_cast<std::int64_t>(value / scale));
  if (decimals != 0) text.add(".");
  for (std::uint64_t rest = value % scale; scale > 1; rest %= scale) {
    scale /= 10;
    text.add(static_cast<std::int64_t>(rest / scale));
  }
}

void add_with_values(TextLine& text, std::string_view comment, Expressions& expressions) {
  int decimals = default_decimals;
  while (!comment.empty() && text.view().size() < max_message) {
    const char next = comment.front();
    if (next == '%' && take_format(comment, decimals)) continue;
    const std::string_view parameter = next == '#' ? parameter_at(comment) : std::string_view{};
    std::int64_t e9 = 0;
    if (!parameter.empty() && expressions.read_parameter(parameter, e9)) {
      add_value(text, e9, decimals);
      comment.remove_prefix(parameter.size());
      continue;
    }
    text.add(front_of(comment, 1));
    comment.remove_prefix(1);
  }
}

}  // namespace

bool take_message(std::string_view& line, Expressions& expressions, TextLine& text) {
  for (;;) {
    line.remove_prefix(index_of(line, '(', ';'));
    if (line.empty() || line.front() == ';') return false;
    line.remove_prefix(1);
    std::string_view comment = front_of(line, index_of(line, ')', ')'));
    line.remove_prefix(comment.size());
    drop_blanks(comment);
    const bool is_plain = take_word(comment, "MSG,");
    if (!is_plain && !take_word(comment, "DEBUG,") && !take_word(comment, "PRINT,")) continue;
    drop_blanks(comment);
    if (is_plain)
      text.add(front_of(comment, max_message));
    else
      add_with_values(text, comment, expressions);
    return true;
  }
}

}  // namespace lamplock::program
