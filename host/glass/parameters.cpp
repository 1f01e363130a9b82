#include "host/glass/parameters.hpp"

#include <fmt/format.h>

#include <cmath>

namespace lamplock::glass {
namespace {

/// Whole numbers in full, others without the noise of the last digits.
std::string number_text(double number) {
  return number == std::floor(number) ? fmt::format("{:.0f}", number)
                                      : fmt::format("{:.9g}", number);
}

}  // namespace

bool Range::has(double value) const {
  const bool above = value > low || (low_included && value == low);
  return std::isfinite(value) && above && value <= high;
}

std::string Range::text() const {
  const std::string from = number_text(low), to = number_text(high);
  if (std::isinf(low)) return std::isinf(high) ? "" : "at most " + to;
  if (std::isinf(high)) return (low_included ? "at least " : "greater than ") + from;
  return low_included ? from + " to " + to : "greater than " + from + ", at most " + to;
}

bool same_value(const Parameter& parameter, const Parameter& other) {
  const auto same = [&other](auto* place) {
    return *place == *std::get<decltype(place)>(other.place);
  };
  return std::visit(same, parameter.place);
}

}  // namespace lamplock::glass
