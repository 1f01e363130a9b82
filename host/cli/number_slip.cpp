#include "host/cli/number_slip.hpp"

#include "host/text.hpp"

namespace lamplock::cli {

std::string with_decimal_point(const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos || text.find('.') != std::string::npos) return "";
  std::string point = text;
  point[comma] = '.';
  return number_of<double>(point) ? point : "";
}

std::string without_unit(const std::string& text) {
  const std::size_t end = text.find_first_not_of("+-.0123456789");
  if (end == std::string::npos || text.find_first_of("0123456789", end) != std::string::npos)
    return "";
  const std::string number = text.substr(0, end);
  return number_of<double>(number) ? number : "";
}

}  // namespace lamplock::cli
