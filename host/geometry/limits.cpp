#include "host/geometry/limits.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace lamplock::geometry {

void require_count(double count, const std::string& where) {
  if (count <= static_cast<double>(max_points)) return;
  throw Error(Exit::bad_input, where,
              fmt::format("about {:.3g} points, at most {} are possible", count, max_points),
              "use a larger spacing or a smaller size");
}

void require_positive(double value, const std::string& where, const std::string& name) {
  if (value > 0 && value <= max_value) return;
  throw Error(Exit::bad_input, where, fmt::format("{} is {}", name, value),
              fmt::format("give a number greater than 0, at most {:g}", max_value));
}

}  // namespace lamplock::geometry
