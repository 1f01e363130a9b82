#include "firmware/program/value_text.hpp"

#include <algorithm>
#include <iterator>

#include "shared/gcode_words.hpp"
#include "shared/int128.hpp"

namespace lamplock::program {
namespace {

constexpr int kept_decimals = 9;
constexpr std::uint32_t powers_of_ten[] = {
    1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
static_assert(std::size(powers_of_ten) == kept_decimals + 1 && max_digits == 9);

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
constexpr bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
constexpr bool is_digit_of_value(char c) { return c >= '0' && c <= '9'; }

}  // namespace

void ValueText::go_to(std::uint16_t index) {
  index_ = index;
  next_ = 0;
  for (; index_ < line_.size(); ++index_) {
    const char c = line_[index_];
    if (c == '(') {
      while (index_ < line_.size() && line_[index_] != ')') ++index_;
    } else if (c == ';') {
      break;
    } else if (!is_blank(c)) {
      next_ = c;
      return;
    }
  }
  index_ = static_cast<std::uint16_t>(line_.size());
}

/// To the next character that counts.
void ValueText::advance() {
  const std::uint32_t next = index_ + 1u;
  if (next < line_.size()) {
    const char c = line_[next];
    if (!is_blank(c) && c != '(' && c != ';') {
      index_ = static_cast<std::uint16_t>(next);
      next_ = c;
      return;
    }
  }
  go_to(static_cast<std::uint16_t>(next));
}

bool ValueText::take(char c) {
  if (next_ != c) return false;
  advance();
  return true;
}

Letters ValueText::take_letters(int count) {
  Letters letters = 0;
  for (; count != 0 && is_letter(next_); --count) {
    letters = with_letter(letters, next_);
    advance();
  }
  return letters;
}

GcodeError ValueText::take_number(std::int64_t& e9) {
  // Both parts have less than ten digits.
  std::uint32_t whole = 0, fraction = 0;
  int digits = 0, decimals = 0, round = 0;
  bool has_digit = false, has_point = false;
  for (;; advance()) {
    const char c = next_;
    if (!is_digit_of_value(c)) {
      if (c != '.' || has_point) break;
      has_point = true;
      continue;
    }
    has_digit = true;
    const auto digit = static_cast<std::uint32_t>(c - '0');
    if (!has_point) {
      if (whole == 0 && digit == 0) continue;  // a leading zero
      if (++digits <= max_digits) whole = whole * 10 + digit;
    } else if (decimals < kept_decimals) {
      ++decimals;
      fraction = fraction * 10 + digit;
    } else if (decimals == kept_decimals) {
      ++decimals;
      round = digit >= 5 ? 1 : 0;  // the first lost digit decides
    }
  }
  const int missing = std::max(kept_decimals - decimals, 0);
  const std::uint64_t e9_of_whole = wide_product(whole, powers_of_ten[kept_decimals]);
  e9 = static_cast<std::int64_t>(e9_of_whole + fraction * powers_of_ten[missing]) + round;
  return has_digit && digits <= max_digits ? GcodeError::none : GcodeError::bad_number;
}

bool ValueText::take_whole(std::uint32_t& number) {
  const std::uint16_t from = index_;
  number = 0;
  int digits = 0;
  for (; is_digit_of_value(next_) && digits < max_digits; ++digits) {
    number = number * 10 + static_cast<std::uint32_t>(next_ - '0');
    advance();
  }
  if (digits != 0 && next_ != '.' && !is_digit_of_value(next_)) return true;
  go_to(from);
  return false;
}

GcodeError ValueText::take_name() {
  name_size_ = 0;
  std::uint16_t index = index_;
  for (++index; index < line_.size() && line_[index] != '>'; ++index) {
    if (is_blank(line_[index])) continue;
    if (name_size_ == name_.size()) return GcodeError::no_room;
    name_[name_size_++] = lower(line_[index]);
  }
  if (index >= line_.size() || name_size_ == 0) return GcodeError::bad_expression;
  go_to(static_cast<std::uint16_t>(index + 1));
  return GcodeError::none;
}

}  // namespace lamplock::program
