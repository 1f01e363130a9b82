#include "host/cli/validators.hpp"

#include <limits>
#include <utility>

namespace lamplock::cli {

CLI::Validator number_in(const glass::Range& range) {
  const auto check = [range](const std::string& text) -> std::string {
    double value = 0;
    if (!CLI::detail::lexical_cast(text, value)) return text + " is not a number";
    return range.refusal(value);
  };
  return {check, ""};
}

CLI::Validator number_from(double low, bool included) {
  return number_in({low, std::numeric_limits<double>::infinity(), included});
}

CLI::Validator file_name() {
  return {[](const std::string& text) { return std::string(text.empty() ? "has no name" : ""); },
          ""};
}

CLI::Validator one_of(std::vector<std::string> names) {
  // Without its description: the help names the choices already.
  return CLI::IsMember(std::move(names)).description("");
}

}  // namespace lamplock::cli
