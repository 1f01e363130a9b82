#include "host/job/read_profile.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "host/file.hpp"
#include "host/former_names.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"
#include "shared/units.hpp"

namespace lamplock::job {
namespace {

using settings::Id;

constexpr std::string_view axis_x_suffix = "_x";

/// The X row of settings that exist once per axis, by their name without suffix.
std::optional<Id> find_per_axis(std::string_view key) {
  const Id id = settings::find_name(std::string(key) + std::string(axis_x_suffix));
  if (id == Id::count) return std::nullopt;
  return id;
}

double number_of(const toml::node& node, const std::string& where, std::string_view key) {
  if (const auto* flag = node.as_boolean()) return flag->get() ? 1.0 : 0.0;
  if (const auto number = node.value<double>(); number && node.is_number()) return *number;
  refuse(where, fmt::format("'{}' must be a number", key), "write it without quotes");
}

void read_axes(Profile& profile, Id x_row, std::string_view key, const toml::node& node,
               const std::string& where) {
  const toml::array* values = node.as_array();
  if (values == nullptr || values->empty() || values->size() > max_axes)
    refuse(where, fmt::format("'{}' must be an array of 1 to {} numbers, X first", key, max_axes),
           fmt::format("write {} = [x, y, z]", key));
  for (std::size_t axis = 0; axis < values->size(); ++axis)
    state_setting(profile, settings::for_axis(x_row, static_cast<int>(axis)),
                  number_of(*values->get(axis), where, key), where);
}

/// Keys of a profile: settings, those that exist once per axis without the suffix of the axis too.
std::vector<std::string> profile_keys() {
  std::vector<std::string> keys{"name", "pendant", "lines"};
  for (const settings::Row& row : settings::table) {
    const std::string_view name = row.name;
    if (name.ends_with(axis_x_suffix))
      keys.emplace_back(name.substr(0, name.size() - axis_x_suffix.size()));
  }
  for (const settings::Row& row : settings::table) keys.emplace_back(row.name);
  return keys;
}

void read_key(Profile& profile, std::string_view key, const toml::node& node,
              const std::string& where) {
  // Not settings: host/pendant/read_key_map.hpp and host/gpio/read_line_table.hpp read these.
  if (key == "pendant" || key == "lines") return;
  if (key == "name") {
    const auto text = node.value<std::string>();
    if (!text || !node.is_string()) refuse(where, "'name' must be a text", "write it in quotes");
    profile.name = *text;
  } else if (const auto x_row = find_per_axis(key)) {
    read_axes(profile, *x_row, key, node, where);
  } else if (const Id id = settings::find_name(key); id != Id::count) {
    state_setting(profile, id, number_of(node, where, key), where);
  } else {
    refuse(where, fmt::format("unknown key '{}'", key),
           did_you_mean(key, profile_keys(),
                        "use the names of the settings table (examples/machine.toml lists them)"));
  }
}

/// The present name of a key, with a note if the file has its former one.
std::string_view name_of_key(const toml::table& table, std::string_view key,
                             const std::string& where) {
  const std::string_view name = present_name(key);
  if (name == key) return key;
  if (table.contains(name))
    refuse(where, fmt::format("'{}' is the former name of '{}', which is given too", key, name),
           fmt::format("give '{}' only", name));
  note_former_name(where, key);
  return name;
}

}  // namespace

Profile read_profile(const std::filesystem::path& file) {
  const toml::table table = read_toml(file);
  Profile profile;
  profile.name = file.stem().string();
  for (const auto& [key, node] : table) {
    const std::string where = toml_location(file, key.source());
    read_key(profile, name_of_key(table, key.str(), where), node, where);
  }
  return profile;
}

}  // namespace lamplock::job
