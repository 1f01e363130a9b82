#include "host/glass/material.hpp"

#include <fmt/format.h>

#include <array>

#include "host/error.hpp"
#include "host/suggestion.hpp"

namespace lamplock::glass {
namespace {

// Data sheets of N-BK7 (SCHOTT) and of fused silica; K9 is the Chinese name of the same crown
// glass.
constexpr std::array known_materials{Material{"k9", 1.5168, "crown glass K9, the usual block"},
                                     Material{"bk7", 1.5168, "crown glass BK7, the same as K9"},
                                     Material{"fused-silica", 1.458, "fused silica, quartz glass"}};

}  // namespace

std::span<const Material> materials() { return known_materials; }

std::vector<std::string> material_names() {
  std::vector<std::string> names;
  names.reserve(known_materials.size());
  for (const Material& material : known_materials) names.emplace_back(material.name);
  return names;
}

double index_of(const std::string& material) {
  for (const Material& one : known_materials)
    if (one.name == material) return one.index;
  throw Error(
      Exit::bad_input, "material", fmt::format("'{}' is not known", material),
      did_you_mean(material, material_names(), "use k9, bk7 or fused-silica, or give the index"));
}

void require_index(double index, const std::string& where) {
  if (index >= 1 && index <= max_index) return;
  throw Error(Exit::bad_input, where, fmt::format("refractive index {:g}", index),
              fmt::format("give 1 (none) to {:g}; K9 has 1.5168", max_index));
}

}  // namespace lamplock::glass
