#include "host/glass/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lamplock::glass {
namespace {

/// Six digits, without an exponent.
std::string six_digits(double value) {
  std::string text = fmt::format("{:.6g}", value);
  if (text.find('e') == std::string::npos) return text;
  constexpr int digits = 6;
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  text = fmt::format("{:.{}f}", value, std::max(decimals, 0));
  if (decimals > 0) text.resize(text.find_last_not_of('0') + 1);
  return text;
}

/// A bound with six digits, whole numbers in full. Rounding leaves it inside the range: `inwards`
/// is 1 for the lower bound, -1 for the upper one.
std::string bound_text(double bound, double inwards) {
  if (bound == std::floor(bound)) return fmt::format("{:.0f}", bound);
  constexpr double last_digit = 1e-5;
  const std::string text = six_digits(bound);
  if ((std::stod(text) - bound) * inwards >= 0) return text;
  return six_digits(bound + inwards * std::abs(bound) * last_digit);
}

}  // namespace

bool Range::has(double value) const {
  const bool above = value > low || (low_included && value == low);
  return std::isfinite(value) && above && value <= high;
}

std::string Range::text() const {
  const std::string from = bound_text(low, 1), to = bound_text(high, -1);
  if (std::isinf(low)) return std::isinf(high) ? "" : "at most " + to;
  if (std::isinf(high)) return (low_included ? "at least " : "more than ") + from;
  return low_included ? from + " to " + to : "more than " + from + ", at most " + to;
}

bool same_value(const Parameter& parameter, const Parameter& other) {
  const auto same = [&other](auto* place) {
    return *place == *std::get<decltype(place)>(other.place);
  };
  return std::visit(same, parameter.place);
}

}  // namespace lamplock::glass
