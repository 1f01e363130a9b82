#include "host/glass/unused_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace lamplock::glass {
namespace {

bool is_for(const Parameter& parameter, const std::string& way) {
  const std::vector<std::string>& all = parameter.used_by;
  return all.empty() || std::find(all.begin(), all.end(), way) != all.end();
}

/// The option, and the key if that is another word.
std::string name_of(const Parameter& parameter) {
  std::string option = parameter.option.substr(2);
  std::replace(option.begin(), option.end(), '-', '_');
  if (option == parameter.key) return parameter.option;
  return fmt::format("{} ({})", parameter.option, parameter.key);
}

template <class Section>
void append_unused(Section section, const std::string& way, std::vector<std::string>& warnings) {
  Section untouched;
  for (std::string& one : unused(parameters(section), parameters(untouched), way))
    warnings.push_back(std::move(one));
}

}  // namespace

bool uses(const std::string& way, const std::string& key) {
  Object object;
  const std::vector<Parameter> all = parameters(object);
  return std::any_of(all.begin(), all.end(), [&](const Parameter& parameter) {
    return parameter.key == key && is_for(parameter, way);
  });
}

std::vector<std::string> unused(const std::vector<Parameter>& said,
                                const std::vector<Parameter>& by_default, const std::string& way) {
  std::vector<std::string> warnings;
  const auto missing = [&](const std::string& key) -> const Parameter* {
    for (std::size_t i = 0; i < said.size(); ++i)
      if (said[i].key == key && same_value(said[i], by_default[i])) return &said[i];
    return nullptr;
  };
  for (std::size_t i = 0; i < said.size(); ++i) {
    const Parameter& one = said[i];
    if (same_value(one, by_default[i])) continue;
    if (!is_for(one, way))
      warnings.push_back(fmt::format("{} does nothing with {}; it is for {}", name_of(one), way,
                                     fmt::join(one.used_by, ", ")));
    else if (const Parameter* needed = missing(one.needs); needed != nullptr)
      warnings.push_back(fmt::format("{} does nothing without {}", name_of(one), name_of(*needed)));
  }
  return warnings;
}

std::vector<std::string> unused(const Object& object, const std::string& way) {
  std::vector<std::string> warnings;
  append_unused(object, way, warnings);
  return warnings;
}

std::vector<std::string> unused(const Description& description, const std::string& order) {
  std::vector<std::string> warnings;
  append_unused(description.glass, "", warnings);
  append_unused(description.order, way_of_order(order), warnings);
  append_unused(description.pause, "", warnings);
  return warnings;
}

}  // namespace lamplock::glass
