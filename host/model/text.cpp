#include "host/model/text.hpp"

#include "host/text.hpp"

namespace lamplock::model {
namespace {

constexpr std::string_view white_space = " \t\r\n\f\v";

template <class Number>
std::optional<Number> to_number(std::string_view field) {
  if (field.size() > 1 && field.front() == '+' && field[1] != '-') field.remove_prefix(1);
  return number_of<Number>(field);
}

}  // namespace

Lines::Lines(std::string_view text)
    : rest_(without_byte_order_mark(text)),
      line_end_(rest_.find('\n') == std::string_view::npos ? '\r' : '\n') {}

std::optional<std::string_view> Lines::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find(line_end_);
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++number_;
  return line;
}

std::string_view next_field(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(white_space);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(begin);
  const std::string_view field = text.substr(0, text.find_first_of(white_space));
  text.remove_prefix(field.size());
  return field;
}

std::optional<double> to_double(std::string_view field) { return to_number<double>(field); }

std::optional<long long> to_integer(std::string_view field) { return to_number<long long>(field); }

bool has_decimal_comma(std::string_view text) {
  const auto is_digit = [](char letter) { return letter >= '0' && letter <= '9'; };
  for (std::size_t i = 1; i + 1 < text.size(); ++i)
    if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1])) return true;
  return false;
}

}  // namespace lamplock::model
