#include "host/material/cut_setting.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <vector>

#include "host/error.hpp"
#include "host/material/fields.hpp"
#include "host/suggestion.hpp"

namespace lamplock::material {
namespace {

[[noreturn]] void refuse_query(const Material& material, const std::string& what,
                               const std::string& remedy) {
  throw Error(Exit::bad_input, title_of(material), what, remedy);
}

/// Throws for a text that is no operation of a setting.
void check_operation(const std::string& operation) {
  Setting any;
  const std::vector<std::string> names = field_named(fields(any), "operation", "setting").names;
  if (std::ranges::find(names, operation) != names.end()) return;
  throw Error(Exit::bad_input, "material library",
              fmt::format("'{}' is not an operation of a setting", operation),
              did_you_mean(operation, names, fmt::format("give {}", fmt::join(names, ", "))));
}

std::string laser_of_settings(const Material& material, const std::vector<Setting>& settings,
                              const std::string& operation) {
  std::set<std::string> lasers;
  for (const Setting& one : settings) lasers.insert(one.laser);
  if (lasers.size() == 1) return *lasers.begin();
  refuse_query(material,
               fmt::format("several lasers have settings for the operation {}", operation),
               fmt::format("name the laser: {}", fmt::join(lasers, ", ")));
}

/// "3, 5 mm": in the order of the library.
std::string thicknesses_text(const std::vector<Setting>& settings) {
  std::vector<std::string> texts;
  texts.reserve(settings.size());
  for (const Setting& one : settings) texts.push_back(fmt::format("{:g}", *one.thickness_mm));
  return fmt::format("{} mm", fmt::join(texts, ", "));
}

/// Of settings of one laser and operation.
const Setting& of_thickness(const std::vector<Setting>& settings, const Material& material,
                            std::optional<double> thickness_mm) {
  const auto with = [&](std::optional<double> wanted_mm) {
    return std::ranges::find_if(settings,
                                [&](const Setting& one) { return one.thickness_mm == wanted_mm; });
  };
  if (thickness_mm)
    if (const auto found = with(thickness_mm); found != settings.end()) return *found;
  if (const auto found = with(std::nullopt); found != settings.end()) return *found;
  if (!thickness_mm)
    refuse_query(material, "its thickness is not known",
                 fmt::format("give a thickness; settings are for {}", thicknesses_text(settings)));
  refuse_query(
      material, fmt::format("there is no setting for {:g} mm", *thickness_mm),
      fmt::format("add one, or use one of the settings for {}", thicknesses_text(settings)));
}

}  // namespace

CutSetting cut_setting(Library& library, const CutQuery& query) {
  check_operation(query.operation);
  const Material material = library.material(query.material);
  if (!material.cuttable && query.operation == "cut")
    refuse_query(material, "it cannot be cut: it absorbs too little of the power",
                 "use another colour or material");
  if (!query.laser.empty()) (void)library.laser(query.laser);
  std::vector<Setting> settings = library.settings_of(material.name);
  std::erase_if(settings, [&](const Setting& one) {
    return one.operation != query.operation || (!query.laser.empty() && one.laser != query.laser);
  });
  if (settings.empty())
    refuse_query(material,
                 fmt::format("there is no setting for the operation {}{}", query.operation,
                             query.laser.empty() ? "" : " with the laser " + query.laser),
                 "add a setting with feed and power of a test cut");
  const Laser laser = library.laser(
      query.laser.empty() ? laser_of_settings(material, settings, query.operation) : query.laser);
  const std::optional<double> thickness_mm =
      query.thickness_mm ? query.thickness_mm : material.thickness_mm;
  const Setting& found = of_thickness(settings, material, thickness_mm);
  return {material.name,      laser.name,      thickness_mm,
          found.feed_mm_min,  found.power_w,   laser.share_of(found.power_w),
          found.passes,       found.air,       found.kerf_mm,
          found.frequency_hz, found.operation, found.number};
}

}  // namespace lamplock::material
