#include "host/material/fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <set>

#include "host/error.hpp"
#include "host/suggestion.hpp"
#include "host/text.hpp"

namespace lamplock::material {
namespace {

/// More than any laser, table or sheet has: a larger number is a mistake.
constexpr double max_power_w = 100'000, max_feed_mm_min = 1'000'000, max_length_mm = 10'000;
constexpr double max_frequency_hz = 100e6;
constexpr int max_passes_of_record = 1000;

constexpr glass::Range power_range{0, max_power_w, false};
constexpr glass::Range feed_range{0, max_feed_mm_min, false};
constexpr glass::Range length_range{0, max_length_mm, false};
constexpr glass::Range pass_range{1, max_passes_of_record, true};

Field note_field(std::string& note) { return {"note", &note, "Remark for users"}; }
Field source_field(std::string& source) {
  return {"source", &source, "Who measured it, or where it is published"};
}
Field material_field(std::string& name) {
  return {.key = "material",
          .place = &name,
          .about = "Name of the material",
          .is_required = true,
          .is_name = true};
}
Field laser_field(std::string& name) {
  return {.key = "laser",
          .place = &name,
          .about = "Name of the laser",
          .is_required = true,
          .is_name = true};
}
Field required_number(std::string_view key, double& value, std::string_view about,
                      const glass::Range& range) {
  return {.key = key, .place = &value, .about = about, .range = range, .is_required = true};
}

[[noreturn]] void refuse_value(const std::string& where, const Field& field,
                               const std::string& what, const std::string& remedy) {
  throw Error(Exit::bad_input, where, fmt::format("'{}' {}", field.key, what), remedy);
}

double number_in_text(const Field& field, std::string_view text, const std::string& where) {
  const auto value = lamplock::number_of<double>(text);
  if (!value)
    refuse_value(where, field, fmt::format("is '{}', not a number", text),
                 "write digits and a decimal point");
  return *value;
}

}  // namespace

std::vector<Field> fields(Laser& l) {
  return {{.key = "name",
           .place = &l.name,
           .about = "Name of the laser",
           .is_required = true,
           .is_name = true},
          required_number("power_w", l.power_w, "Full power of the beam, W", power_range),
          {"wavelength_nm", &l.wavelength_nm, "Wavelength, nm", {100, 20'000}},
          {"beam_shape",
           &l.beam_shape,
           "Shape of the beam on the material",
           {},
           {"round", "rectangle", "ellipse"}},
          required_number("beam_width_mm", l.beam_width_mm, "Width of the beam on the material, mm",
                          length_range),
          {"beam_height_mm", &l.beam_height_mm, "Height of the beam, mm; none: the width",
           length_range},
          note_field(l.note),
          source_field(l.source)};
}

std::vector<Field> fields(Material& m) {
  return {
      {.key = "name",
       .place = &m.name,
       .about = "Name of the material",
       .is_required = true,
       .is_name = true},
      {"colour", &m.colour, "Colour, which decides how much power is absorbed"},
      {"thickness_mm", &m.thickness_mm, "Thickness of a sheet, mm", length_range},
      {"density_g_cm3", &m.density_g_cm3, "Density, g/cm3", {0, 30, false}},
      {"specific_energy_kj_g",
       &m.specific_energy_kj_g,
       "Energy to heat and evaporate it, kJ/g",
       {0, 1000, false}},
      {"absorption", &m.absorption, "Absorbed part of the power, 0 to 1", {0, 1, false}},
      {"cuttable", &m.cuttable, "false: absorbs too little power to be cut"},
      {"burn_feed_mm_min", &m.burn_feed_mm_min,
       "Its edges burn at this feed and slower ones, mm/min", feed_range},
      {"conductivity_w_mk",
       &m.conductivity_w_mk,
       "Thermal conductivity, W/(m K)",
       {0, 10'000, false}},
      {"specific_heat_j_gk", &m.specific_heat_j_gk, "Specific heat, J/(g K)", {0, 100, false}},
      {"absorption_per_mm",
       &m.absorption_per_mm,
       "Absorption coefficient for the laser, 1/mm; none: absorbed in the surface",
       {0, 1e6, false}},
      {"emissivity", &m.emissivity, "Emissivity of the surface, 0 to 1", {0, 1, false}},
      {"latent_heat_j_g", &m.latent_heat_j_g, "Heat of evaporation, J/g", {0, 1e6, false}},
      {"molar_mass_g_mol", &m.molar_mass_g_mol, "Molar mass of the vapour, g/mol", {0, 1e4, false}},
      {"boiling_k", &m.boiling_k, "Boiling point at 101325 Pa, K", {0, 10'000, false}},
      {"thermal_source", &m.thermal_source, "Where the thermal constants are published"},
      note_field(m.note),
      source_field(m.source)};
}

std::vector<Field> fields(Setting& s) {
  return {
      material_field(s.material),
      laser_field(s.laser),
      {"thickness_mm", &s.thickness_mm, "Thickness of the material, mm; none: any", length_range},
      {"operation", &s.operation, "Operation", {}, {"cut", "score", "engrave"}},
      required_number("feed_mm_min", s.feed_mm_min, "Feed, mm/min", feed_range),
      required_number("power_w", s.power_w, "Power of the beam, W", power_range),
      {"passes", &s.passes, "Number of passes", pass_range},
      {"min_feed_mm_min", &s.min_feed_mm_min, "Slowest good feed, mm/min", feed_range},
      {"max_feed_mm_min", &s.max_feed_mm_min, "Fastest good feed, mm/min", feed_range},
      {"air", &s.air, "true: with air assist"},
      {"kerf_mm", &s.kerf_mm, "Width of the cut, mm", length_range},
      {"frequency_hz",
       &s.frequency_hz,
       "Pulses of the beam a second, Hz; none: continuous",
       {0, max_frequency_hz, false}},
      note_field(s.note),
      source_field(s.source)};
}

std::vector<Field> fields(Measurement& m) {
  return {material_field(m.material),
          laser_field(m.laser),
          required_number("feed_mm_min", m.feed_mm_min, "Feed of the test cut, mm/min", feed_range),
          required_number("power_w", m.power_w, "Power of the beam, W", power_range),
          {"passes", &m.passes, "Number of passes", pass_range},
          {"depth_mm", &m.depth_mm, "Depth of the groove after all passes, mm", length_range},
          {"thickness_mm", &m.thickness_mm, "Thickness of the sheet, mm", length_range},
          {"result", &m.result, "How the cut ended", {}, {"cut", "almost", "not-cut"}},
          {"rejected", &m.rejected, "true: known to be wrong, used by no fit"},
          note_field(m.note),
          source_field(m.source)};
}

std::vector<std::string> keys_of(const std::vector<Field>& fields) {
  std::vector<std::string> keys;
  keys.reserve(fields.size());
  for (const Field& field : fields) keys.emplace_back(field.key);
  return keys;
}

bool is_absent(const Field& field) {
  if (const auto* number = std::get_if<std::optional<double>*>(&field.place))
    return !(*number)->has_value();
  if (const auto* text = std::get_if<std::string*>(&field.place)) return (*text)->empty();
  return false;
}

namespace {

struct TextOfValue {
  std::string operator()(const double* value) const { return fmt::format("{}", *value); }
  std::string operator()(const std::optional<double>* value) const {
    return *value ? fmt::format("{}", **value) : "";
  }
  std::string operator()(const int* value) const { return fmt::format("{}", *value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return *value; }
};

struct ValueSetter {
  const Field& field;
  std::string_view text;
  const std::string& where;

  void operator()(double* value) const { *value = number_in_text(field, text, where); }
  void operator()(std::optional<double>* value) const {
    if (text.empty())
      value->reset();
    else
      *value = number_in_text(field, text, where);
  }
  void operator()(int* value) const {
    const auto number = lamplock::number_of<int>(text);
    if (!number)
      refuse_value(where, field, fmt::format("is '{}', not a whole number", text),
                   "write digits only");
    *value = *number;
  }
  void operator()(bool* value) const {
    if (text != "true" && text != "false")
      refuse_value(where, field, fmt::format("is '{}'", text), "give true or false");
    *value = text == "true";
  }
  void operator()(std::string* value) const { *value = text; }
};

}  // namespace

std::string value_text(const Field& field) { return std::visit(TextOfValue{}, field.place); }

void set_value(const Field& field, std::string_view text, const std::string& where) {
  std::visit(ValueSetter{field, text, where}, field.place);
}

const Field& field_named(const std::vector<Field>& fields, std::string_view key,
                         const std::string& where) {
  const auto found =
      std::ranges::find_if(fields, [key](const Field& field) { return field.key == key; });
  if (found != fields.end()) return *found;
  const std::vector<std::string> keys = keys_of(fields);
  throw Error(Exit::bad_input, where, fmt::format("unknown field '{}'", key),
              did_you_mean(key, keys, fmt::format("use {}", fmt::join(keys, ", "))));
}

template <class Record>
void apply_changes(Record& record, const std::vector<std::string>& changes,
                   const std::string& where) {
  const std::vector<Field> all = fields(record);
  std::set<std::string_view> given;
  for (const std::string& change : changes) {
    const std::size_t equals = change.find('=');
    if (equals == std::string::npos)
      throw Error(Exit::bad_input, where, fmt::format("'{}' has no '='", change),
                  "write FIELD=VALUE");
    const Field& field = field_named(all, std::string_view(change).substr(0, equals), where);
    if (!given.insert(field.key).second)
      throw Error(Exit::bad_input, where, fmt::format("'{}' is given twice", field.key),
                  "give it once");
    set_value(field, std::string_view(change).substr(equals + 1), where);
  }
}

template void apply_changes(Laser&, const std::vector<std::string>&, const std::string&);
template void apply_changes(Material&, const std::vector<std::string>&, const std::string&);
template void apply_changes(Setting&, const std::vector<std::string>&, const std::string&);
template void apply_changes(Measurement&, const std::vector<std::string>&, const std::string&);

}  // namespace lamplock::material
