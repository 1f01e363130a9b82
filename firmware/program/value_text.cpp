#include "firmware/program/value_text.hpp"

#include "shared/gcode_words.hpp"

namespace lamplock::program {
namespace {

constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
constexpr bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
constexpr bool is_digit_of_value(char c) { return c >= '0' && c <= '9'; }

/// Collects the digits of a number.
class ValueDigits {
 public:
  void add(char c) {
    has_digit_ = true;
    if (has_point_ && decimals_ >= kept_decimals) {
      if (decimals_++ == kept_decimals && c >= '5') round_ = 1;  // the first lost digit decides
      return;
    }
    if (has_point_)
      ++decimals_;
    else if (e9_ != 0 || c != '0')
      ++digits_;
    if (digits_ <= max_digits) e9_ = e9_ * 10 + (c - '0');
  }
  bool add_point() {
    const bool is_first = !has_point_;
    has_point_ = true;
    return is_first;
  }
  bool is_good() const { return has_digit_ && digits_ <= max_digits; }
  std::int64_t value_e9() const {
    std::int64_t e9 = e9_;
    for (int i = decimals_; i < kept_decimals; ++i) e9 *= 10;
    return e9 + round_;
  }

 private:
  static constexpr int kept_decimals = 9;

  std::int64_t e9_ = 0;
  int digits_ = 0;  ///< before the point, without leading zeros
  int decimals_ = 0, round_ = 0;
  bool has_digit_ = false, has_point_ = false;
};

}  // namespace

char ValueText::peek() {
  for (; index_ < line_.size(); ++index_) {
    const char c = line_[index_];
    if (c == '(') {
      while (index_ < line_.size() && line_[index_] != ')') ++index_;
      if (index_ == line_.size()) return 0;
    } else if (c == ';') {
      index_ = static_cast<std::uint16_t>(line_.size());
      return 0;
    } else if (!is_blank(c)) {
      return c;
    }
  }
  return 0;
}

bool ValueText::take(char c) {
  if (peek() != c) return false;
  ++index_;
  return true;
}

bool ValueText::take_word(std::string_view text) {
  const std::uint16_t from = index_;
  for (const char c : text) {
    if (upper(peek()) != c) {
      index_ = from;
      return false;
    }
    ++index_;
  }
  return true;
}

GcodeError ValueText::take_number(std::int64_t& e9) {
  ValueDigits digits;
  for (char c = peek();; ++index_, c = peek()) {
    if (is_digit_of_value(c))
      digits.add(c);
    else if (c != '.' || !digits.add_point())
      break;
  }
  e9 = digits.value_e9();
  return digits.is_good() ? GcodeError::none : GcodeError::bad_number;
}

GcodeError ValueText::take_name() {
  name_size_ = 0;
  for (++index_; index_ < line_.size() && line_[index_] != '>'; ++index_) {
    if (is_blank(line_[index_])) continue;
    if (name_size_ == name_.size()) return GcodeError::no_room;
    name_[name_size_++] = lower(line_[index_]);
  }
  if (index_ >= line_.size() || name_size_ == 0) return GcodeError::bad_expression;
  ++index_;
  return GcodeError::none;
}

}  // namespace lamplock::program
