#include "host/job/profile.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/gpio/line_table.hpp"
#include "host/toml_file.hpp"
#include "host/units.hpp"
#include "shared/units.hpp"

namespace lamplock::job {
namespace {

using settings::Id;
using settings::Row;
using settings::setting_count;

constexpr std::string_view first_axis_suffix = "_x";

/// A value in thousandths as a person writes it: no trailing zeros.
std::string format_milli(std::int32_t milli) {
  const std::string text = fmt::format("{:.3f}", milli / milli_per_unit);
  const auto last = text.find_last_not_of('0');
  return text.substr(0, text[last] == '.' ? last : last + 1);
}

std::string range_of(const Row& row) {
  return fmt::format("{} is {}..{} {}{}", row.name, format_milli(row.min_milli),
                     format_milli(row.max_milli), row.unit, row.whole ? ", a whole number" : "");
}

/// The X row of settings that exist once per axis, by their name without suffix.
std::optional<Id> find_per_axis(std::string_view key) {
  const Id id = settings::find_name(std::string(key) + std::string(first_axis_suffix));
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

void read_key(Profile& profile, std::string_view key, const toml::node& node,
              const std::string& where) {
  // No settings: host/pendant/key_map.hpp and host/gpio/line_table.hpp read them.
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
           "use the names of the settings table (examples/machine.toml lists them)");
  }
}

}  // namespace

Profile default_profile() { return {}; }

Profile read_profile(const std::filesystem::path& file) {
  const toml::table table = read_toml(file);
  Profile profile;
  profile.name = file.stem().string();
  if (table.contains("lines")) gpio::read_machine_lines(file);  // refuses what is wrong in it
  for (const auto& [key, node] : table)
    read_key(profile, key.str(), node, toml_location(file, key.source()));
  return profile;
}

void state_setting(Profile& profile, Id id, double value, const std::string& where) {
  const Row& row = settings::row(id);
  const double milli = std::round(value * milli_per_unit);
  const bool fits = milli >= static_cast<double>(std::numeric_limits<std::int32_t>::min()) &&
                    milli <= static_cast<double>(std::numeric_limits<std::int32_t>::max());
  if (!fits || !profile.settings.set_milli(id, static_cast<std::int32_t>(milli)))
    throw Error(Exit::bad_input, where, fmt::format("{} = {} is out of range", row.name, value),
                range_of(row));
  // For many settings 0 is none, or no limit: not what a small number means.
  if (value != 0 && milli == 0)
    throw Error(Exit::bad_input, where,
                fmt::format("{} = {} cannot be told from 0", row.name, value),
                "settings are kept to 0.001; give 0 or more than that");
  profile.stated.set(static_cast<std::size_t>(id));
}

void set_lamp_hz(Profile& profile, double hz) {
  state_setting(profile, Id::lamp_frequency, hz, "--lamp");
}

void set_acceleration(Profile& profile, double m_s2) {
  for (int axis = 0; axis < max_axes; ++axis)
    state_setting(profile, settings::for_axis(Id::acceleration_x, axis), m_s2 * mm_s2_per_m_s2,
                  "--accel");
}

void set_speed(Profile& profile, double m_s) {
  for (int axis = 0; axis < max_axes; ++axis)
    state_setting(profile, settings::for_axis(Id::max_rate_x, axis), m_s * mm_min_per_m_s,
                  "--speed");
}

}  // namespace lamplock::job
