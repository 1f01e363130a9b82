#include "host/job/setting_range.hpp"

#include <fmt/format.h>

#include "host/units.hpp"

namespace lamplock::job {

std::string setting_range(const settings::Row& row) {
  if (row.unit == "on/off") return "give 0 (off) or 1 (on)";
  return fmt::format("give {} to {}{}{}", row.min_milli / milli_per_unit,
                     row.max_milli / milli_per_unit, unit_suffix(row),
                     row.whole ? ", a whole number" : "");
}

std::string unit_suffix(const settings::Row& row) {
  const bool is_choice = row.unit.empty() || row.unit == "on/off" || row.unit == "count" ||
                         row.unit.find("..") != std::string_view::npos;
  return is_choice ? "" : fmt::format(" {}", row.unit);
}

}  // namespace lamplock::job
