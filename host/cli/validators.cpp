#include "host/cli/validators.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "host/text.hpp"

namespace lamplock::cli {

Check number_in(const glass::Range& range) {
  const auto refusal = [range](const std::string& text) -> std::string {
    std::string_view digits = text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto value = number_of<double>(digits);
    if (!value) return fmt::format("'{}' is not a number", text);
    return range.has(*value) ? "" : fmt::format("{} is out of range", text);
  };
  return {refusal, range.text()};
}

Check number_from(double low, bool included) {
  return number_in({low, std::numeric_limits<double>::infinity(), included});
}

Check one_of(std::vector<std::string> names) {
  const auto refusal = [names](const std::string& text) -> std::string {
    if (std::find(names.begin(), names.end(), text) != names.end()) return "";
    return fmt::format("'{}' is not one of {}", text, fmt::join(names, ", "));
  };
  return {refusal, "", std::move(names)};
}

}  // namespace lamplock::cli
