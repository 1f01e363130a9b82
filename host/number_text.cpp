#include "host/number_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamplock {

std::string grouped(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i != 0 && (digits.size() - i) % 3 == 0) text.push_back(' ');
    text.push_back(digits[i]);
  }
  return text;
}

std::string number_text(double value, int digits) {
  constexpr double rounding = 1e-6;
  constexpr int max_decimals = 9;
  if (!std::isfinite(value)) return fmt::format("{}", value);
  if (std::abs(value) < rounding) return "0";
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  const int decimals = std::clamp(digits - before_point, 0, max_decimals);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string count_text(std::size_t count, std::string_view noun, std::string_view plural) {
  const std::string number = grouped(count);
  if (count == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", number, noun)
                        : fmt::format("{} {}", number, plural);
}

}  // namespace lamplock
