#include "shared/gcode_words.hpp"

#include <array>

namespace lamplock::program {
namespace {

constexpr std::array<std::uint32_t, 8> power_of_ten{1,      10,      100,       1'000,
                                                    10'000, 100'000, 1'000'000, 10'000'000};

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
/// The next word, or the next part of a list of powers.
constexpr bool begins_other(char c) { return is_letter(c) || c == ':' || c == '*'; }

/// Appends the digits at the front of a text to a number; returns where they end.
inline const char* add_digits(const char* at, const char* end, std::uint32_t& number) {
  std::uint32_t n = number;
  for (; at != end; ++at) {
    const auto digit = static_cast<std::uint32_t>(*at) - '0';
    if (digit > 9) break;
    n = n * 10 + digit;
  }
  number = n;
  return at;
}

/// Nearest whole number to value / divisor, half away from zero.
std::int64_t nearest_quotient(std::int64_t value, std::uint32_t divisor) {
  const std::int64_t half = divisor / 2;
  return (value < 0 ? value - half : value + half) / std::int64_t{divisor};
}

/// Collects the digits of a number, in groups that fit into 32 bits.
class Digits {
 public:
  void add(std::uint32_t digit, bool point) {
    any_ = true;
    if (point) {
      if (behind_++ >= max_decimals) return round(digit);
    } else if ((digit != 0 || before_ != 0) && ++before_ > max_digits) {
      return;
    }
    if (grouped_ == group_digits) close_group();
    group_ = group_ * 10 + digit;
    ++grouped_;
  }

  std::int64_t value() const {
    if (all_ == 0) return std::int64_t{group_} + carry_;
    return all_ * std::int64_t{power_of_ten_of(grouped_)} + group_ + carry_;
  }
  int decimals() const { return behind_ < max_decimals ? behind_ : max_decimals; }
  bool good() const { return any_ && before_ <= max_digits; }

 private:
  static constexpr int group_digits = 9;
  static std::uint32_t power_of_ten_of(int digits) {
    std::uint32_t power = 1;
    for (; digits > 0; --digits) power *= 10;
    return power;
  }
  void close_group() {
    all_ = value();
    group_ = 0;
    grouped_ = 0;
  }
  /// The first dropped digit decides.
  void round(std::uint32_t digit) {
    if (behind_ == max_decimals + 1 && digit >= 5) carry_ = 1;
  }

  std::int64_t all_ = 0;
  std::uint32_t group_ = 0, carry_ = 0;
  int grouped_ = 0;
  int before_ = 0;  ///< digits before the point, leading zeros omitted
  int behind_ = 0;
  bool any_ = false;
};

}  // namespace

[[gnu::hot]] std::int64_t scaled(const Word& word, std::uint32_t factor, int digits) {
  const int shift = digits - word.decimals;
  if (shift >= 0)
    return word.mantissa * std::int64_t{factor * power_of_ten[static_cast<std::size_t>(shift)]};
  return nearest_quotient(word.mantissa * std::int64_t{factor},
                          power_of_ten[static_cast<std::size_t>(-shift)]);
}

GcodeError whole(const Word& word, std::uint32_t& number) {
  std::int64_t value = word.mantissa;
  if (word.decimals != 0) {
    const std::uint32_t power = power_of_ten[word.decimals];
    value = word.mantissa / std::int64_t{power};
    if (value * std::int64_t{power} != word.mantissa) return GcodeError::not_integer;
  }
  if (value < 0) return GcodeError::negative_value;
  number = static_cast<std::uint32_t>(value);  // below 10^9
  return GcodeError::none;
}

void WordReader::skip_comment() {
  std::size_t text = place_ + std::size_t{1};
  while (text < line_.size() && (line_[text] == ' ' || line_[text] == '\t')) ++text;
  if (text < line_.size()) {
    const char first = static_cast<char>(line_[text] | 0x20);  // in lower case
    has_message_ = has_message_ || first == 'm' || first == 'd' || first == 'p';
  }
  while (place_ < line_.size() && line_[place_] != ')') ++place_;
}

[[gnu::hot]] char WordReader::peek() {
  for (; place_ < line_.size(); ++place_) {
    const char c = line_[place_];
    if (c == '(') {
      skip_comment();
      if (place_ == line_.size()) return 0;
    } else if (c == ';') {
      place_ = static_cast<std::uint16_t>(line_.size());
      return 0;
    } else if (static_cast<unsigned char>(c) > ' ' && c != '/' && c != '%') {
      return c;
    }
  }
  return 0;
}

[[gnu::hot]] bool WordReader::take(char c) {
  if (peek() != c) return false;
  ++place_;
  return true;
}

/// A number of up to nine digits without separators, up to the next word or the end of the line:
/// nearly all of them. False for any other.
[[gnu::hot]] bool WordReader::read_plain_number(Word& word) {
  constexpr std::ptrdiff_t max_digits_32 = 9;
  const char* const text = line_.data();
  const char* const end = text + line_.size();
  const char* at = text + place_;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint32_t number = 0;
  const char* const first = at;
  at = add_digits(at, end, number);
  std::ptrdiff_t digits = at - first, decimals = 0;
  if (at != end && *at == '.') {
    const char* const point = ++at;
    at = add_digits(at, end, number);
    decimals = at - point;
    digits += decimals;
  }
  if (digits == 0 || digits > max_digits_32 || decimals > max_decimals) return false;
  if (at != end && !begins_other(*at)) return false;
  word.mantissa = negative ? -std::int64_t{number} : std::int64_t{number};
  word.decimals = static_cast<std::uint8_t>(decimals);
  place_ = static_cast<std::uint16_t>(at - text);
  return true;
}

[[gnu::hot]] bool WordReader::read_number(Word& word) {
  if (read_plain_number(word)) return true;
  Digits digits;
  char c = peek();
  const bool negative = c == '-';
  if (c == '-' || c == '+') ++place_;
  for (bool point = false;; ++place_) {
    c = place_ < line_.size() ? line_[place_] : '\0';
    if (!is_digit(c)) c = peek();
    if (is_digit(c))
      digits.add(static_cast<std::uint32_t>(c - '0'), point);
    else if (c == '.' && !point)
      point = true;
    else
      break;
  }
  const std::int64_t value = digits.value();
  word.mantissa = negative ? -value : value;
  word.decimals = static_cast<std::uint8_t>(digits.decimals());
  return digits.good();
}

[[gnu::hot]] Fault WordReader::next(Word& word) {
  char c = place_ < line_.size() ? line_[place_] : '\0';
  if (!is_letter(c)) c = peek();
  word.letter = 0;
  word.column = static_cast<std::uint16_t>(place_ + 1);
  if (c == 0) return {};
  if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  if (c < 'A' || c > 'Z') return {GcodeError::letter_expected, word.column};
  word.letter = c;
  ++place_;
  if (!read_number(word)) return {GcodeError::bad_number, word.column};
  return {};
}

}  // namespace lamplock::program
