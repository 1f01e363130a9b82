#include "host/glass/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace lamplock::glass {

std::string Range::refusal(double value) const {
  const bool above = value > low || (low_included && value == low);
  if (std::isfinite(value) && above && value <= high) return "";
  if (std::isinf(low)) return fmt::format("{:g} is not a finite number", value);
  if (!std::isinf(high)) return fmt::format("{:g} is not in {:g}..{:g}", value, low, high);
  return fmt::format("{:g} is not {} {:g}", value, low_included ? "at least" : "greater than", low);
}

std::string refusal(const Parameter& parameter, const std::string& text) {
  if (parameter.check != nullptr) return parameter.check(text);
  const std::vector<std::string>& names = parameter.names;
  if (names.empty() || std::find(names.begin(), names.end(), text) != names.end()) return "";
  return fmt::format("'{}' is not one of {}", text, fmt::join(names, ", "));
}

bool same_value(const Parameter& parameter, const Parameter& other) {
  const auto same = [&other](auto* place) {
    return *place == *std::get<decltype(place)>(other.place);
  };
  return std::visit(same, parameter.place);
}

}  // namespace lamplock::glass
