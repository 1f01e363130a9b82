#include "host/job/setting_range.hpp"

#include <fmt/format.h>

#include "host/units.hpp"

namespace lamplock::job {

std::string setting_range(const settings::Row& row) {
  if (row.unit == "on/off") return "give 0 (off) or 1 (on)";
  // The unit of a choice is its range.
  const bool has_unit =
      !row.unit.empty() && row.unit != "count" && row.unit.find("..") == std::string_view::npos;
  return fmt::format("give {} to {}{}{}{}", row.min_milli / milli_per_unit,
                     row.max_milli / milli_per_unit, has_unit ? " " : "", has_unit ? row.unit : "",
                     row.whole ? ", a whole number" : "");
}

}  // namespace lamplock::job
