#include "host/cli/material_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "host/material/fields.hpp"
#include "host/number_text.hpp"

namespace lamplock::cli {
namespace {

using material::Field;

struct JsonOfValue {
  Json operator()(const double* value) const { return *value; }
  Json operator()(const std::optional<double>* value) const {
    return *value ? Json(**value) : Json();
  }
  Json operator()(const int* value) const { return *value; }
  Json operator()(const bool* value) const { return *value; }
  Json operator()(const std::string* value) const { return *value; }
};

/// "  TEXT VALUE UNIT" or nothing.
std::string part(const char* text, const std::optional<double>& value, const char* unit) {
  return value ? fmt::format("  {}{:g} {}", text, *value, unit) : "";
}
std::string part(const std::string& text) { return text.empty() ? "" : "  " + text; }

}  // namespace

template <class Record>
Json record_json(Record record) {
  Json json{{"number", record.number}};
  for (const Field& field : fields(record))
    json[std::string(field.key)] = std::visit(JsonOfValue{}, field.place);
  return json;
}
template Json record_json(material::Laser);
template Json record_json(material::Material);
template Json record_json(material::Setting);
template Json record_json(material::Measurement);

std::string line_of(const material::Laser& laser) {
  const double height_mm = laser.beam_height_mm.value_or(laser.beam_width_mm);
  return fmt::format("{:<16}  {:g} W{}  {} beam of {:g} x {:g} mm", laser.name, laser.power_w,
                     part("", laser.wavelength_nm, "nm"), laser.beam_shape, laser.beam_width_mm,
                     height_mm);
}

std::string line_of(const material::Material& material) {
  return fmt::format(
      "{:<16}{}{}{}{}{}{}", material.name, part(material.colour),
      part("", material.thickness_mm, "mm"), part("", material.density_g_cm3, "g/cm3"),
      part("", material.specific_energy_kj_g, "kJ/g"),
      material.absorption ? fmt::format("  absorbs {:g} of the power", *material.absorption) : "",
      material.cuttable ? "" : "  cannot be cut");
}

std::string line_of(const material::Setting& setting) {
  const std::string range =
      setting.min_feed_mm_min || setting.max_feed_mm_min
          ? fmt::format(" ({:g} to {:g})", setting.min_feed_mm_min.value_or(setting.feed_mm_min),
                        setting.max_feed_mm_min.value_or(setting.feed_mm_min))
          : "";
  return fmt::format(
      "{:>5}  {:<16}  {}  {}{}  {:g} mm/min{}  {:g} W  {}{}{}{}", setting.number, setting.material,
      setting.laser, setting.operation, part("", setting.thickness_mm, "mm"), setting.feed_mm_min,
      range, setting.power_w,
      lamplock::count_text(static_cast<std::size_t>(setting.passes), "pass", "passes"),
      setting.air ? "  air" : "", part("kerf ", setting.kerf_mm, "mm"),
      part("", setting.frequency_hz, "Hz"));
}

std::string line_of(const material::Measurement& measurement) {
  return fmt::format(
      "{:>5}  {:<16}  {}  {:g} mm/min  {:g} W  {}{}{}{}{}", measurement.number,
      measurement.material, measurement.laser, measurement.feed_mm_min, measurement.power_w,
      lamplock::count_text(static_cast<std::size_t>(measurement.passes), "pass", "passes"),
      part("depth ", measurement.depth_mm, "mm"), part("sheet of ", measurement.thickness_mm, "mm"),
      part(measurement.result), measurement.rejected ? "  rejected" : "");
}

std::string fit_text(const material::MaterialFit& fit) {
  return fmt::format("B {:.5f}  w {:.5f}  rms {:.3f}", fit.fit.correction.factor,
                     fit.fit.correction.exponent, fit.fit.rms);
}

Json fit_json(const material::MaterialFit& fit) {
  return {{"B", fit.fit.correction.factor},
          {"w", fit.fit.correction.exponent},
          {"rms", fit.fit.rms},
          {"poor", fit.fit.is_poor()},
          {"measurements", fit.measurements},
          {"min_feed_mm_min", fit.feed_mm_min.min},
          {"max_feed_mm_min", fit.feed_mm_min.max},
          {"min_power_w", fit.power_w.min},
          {"max_power_w", fit.power_w.max}};
}

Json best_json(const material::BestCut& best) {
  return {{"feed_mm_min", best.feed_mm_min},
          {"power_w", best.power_w},
          {"depth_mm", best.depth_mm ? Json(*best.depth_mm) : Json()},
          {"passes", best.passes},
          {"max_measured_passes", best.max_measured_passes},
          {"time_s", best.time_s},
          {"burns", best.burns},
          {"candidates", best.candidates},
          {"min_feed_mm_min", best.measured_feed_mm_min.min},
          {"max_feed_mm_min", best.measured_feed_mm_min.max},
          {"rejected_depth_mm", best.rejected_depth_mm ? Json(*best.rejected_depth_mm) : Json()}};
}

}  // namespace lamplock::cli
