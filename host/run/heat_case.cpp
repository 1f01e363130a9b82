#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/material/record_file.hpp"
#include "host/run/heat.hpp"
#include "host/run/material_records.hpp"

namespace lamplock::run {
namespace {

using thermal::Body;
using thermal::Surface;

constexpr std::array loss_names{"convection", "radiation", "evaporation"};

Error heat_refusal(const std::string& where, const std::string& what, const std::string& remedy) {
  return {Exit::bad_input, where, what, remedy};
}

/// The one material of a file, or the one with the name.
material::Material material_in_file(const std::string& file, const std::string& name) {
  const std::vector<material::Material> all = material::read_records(file).materials;
  if (name.empty() && all.size() == 1) return all.front();
  for (const material::Material& one : all)
    if (one.name == name) return one;
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const material::Material& one : all) names.push_back(one.name);
  throw heat_refusal(file,
                     name.empty() ? fmt::format("it has {} materials", all.size())
                                  : fmt::format("it has no material '{}'", name),
                     names.empty() ? "add a [[material]]"
                                   : fmt::format("give --material {}", fmt::join(names, " or ")));
}

material::Material material_of(const HeatOptions& options) {
  if (!options.materials.empty()) return material_in_file(options.materials, options.material);
  if (options.material.empty())
    throw heat_refusal("heat", "no material is given",
                       "name one with --material: lamplock material list");
  return library_for_reading(options.library).material(options.material);
}

/// The record of a material, and the file that it is from; empty: the library.
struct MaterialRecord {
  material::Material material;
  std::string file;

  double needed(const std::optional<double>& value, const char* key) const {
    if (value) return *value;
    throw heat_refusal(
        fmt::format("material {}", material.name), fmt::format("it has no {}", key),
        file.empty() ? fmt::format("add it: lamplock material edit {} {}=VALUE", material.name, key)
                     : fmt::format("add {} = VALUE to its record in {}", key, file));
  }
};

Body body_of(const MaterialRecord& record, bool is_lit) {
  const material::Material& m = record.material;
  constexpr double g_mm3_per_g_cm3 = 1e-3, w_mmk_per_w_mk = 1e-3;
  Body body;
  body.conductivity_w_mmk =
      record.needed(m.conductivity_w_mk, "conductivity_w_mk") * w_mmk_per_w_mk;
  body.heat_j_mm3k = record.needed(m.density_g_cm3, "density_g_cm3") * g_mm3_per_g_cm3 *
                     record.needed(m.specific_heat_j_gk, "specific_heat_j_gk");
  if (!is_lit) return body;
  body.absorption = record.needed(m.absorption, "absorption");
  body.absorption_per_mm = m.absorption_per_mm;
  return body;
}

std::vector<std::string> chosen_losses(const std::string& text) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, end - begin));
    if (std::ranges::find(loss_names, names.back()) == loss_names.end())
      throw heat_refusal(
          "--losses", fmt::format("'{}' is not the name of a loss", names.back()),
          fmt::format("give known, none, or some of {}", fmt::join(loss_names, ",")));
    begin = end + 1;
  }
  return names;
}

Surface surface_of(const HeatOptions& options, const MaterialRecord& record,
                   std::vector<std::string>& omitted) {
  const material::Material& m = record.material;
  Surface surface;
  surface.ambient_k = options.ambient_k;
  if (options.losses == "none") return surface;
  const bool takes_known = options.losses == "known";
  const std::vector<std::string> chosen =
      takes_known ? std::vector<std::string>(loss_names.begin(), loss_names.end())
                  : chosen_losses(options.losses);
  const auto has = [&](const char* name) {
    return std::ranges::find(chosen, name) != chosen.end();
  };
  if (has("convection"))
    surface.convection_w_mm2k = options.convection_w_m2k / thermal::w_m2_per_w_mm2;
  if (has("radiation")) {
    if (!takes_known || m.emissivity)
      surface.emissivity = record.needed(m.emissivity, "emissivity");
    else
      omitted.emplace_back("radiation (no emissivity)");
  }
  if (has("evaporation")) {
    if (!takes_known || (m.latent_heat_j_g && m.molar_mass_g_mol && m.boiling_k))
      surface.evaporation = {record.needed(m.latent_heat_j_g, "latent_heat_j_g"),
                             record.needed(m.molar_mass_g_mol, "molar_mass_g_mol"),
                             record.needed(m.boiling_k, "boiling_k")};
    else
      omitted.emplace_back("evaporation (no latent_heat_j_g, molar_mass_g_mol or boiling_k)");
  }
  return surface;
}

void add_laser(const HeatOptions& options, HeatCase& heat) {
  if (!options.laser.empty()) {
    const material::Laser laser = library_for_reading(options.library).laser(options.laser);
    heat.laser_w = heat.power_w = laser.power_w;
    heat.beam = {laser.beam_shape == "rectangle", laser.beam_width_mm / 2,
                 laser.beam_height_mm.value_or(laser.beam_width_mm) / 2};
  }
  if (options.power_w) heat.power_w = *options.power_w;
  if (options.beam_mm) heat.beam = {false, *options.beam_mm / 2, *options.beam_mm / 2};
  if (options.laser.empty() && (!options.power_w || !options.beam_mm))
    throw heat_refusal("heat", "power and beam are not given",
                       "give --power and --beam, or a laser of the library with --laser");
}

}  // namespace

HeatCase heat_case(const HeatOptions& options, bool needs_laser) {
  const MaterialRecord record{material_of(options), options.materials};
  const material::Material& m = record.material;
  HeatCase heat;
  heat.material = m.name;
  heat.thermal_source = m.thermal_source;
  heat.body = body_of(record, needs_laser);
  heat.surface = surface_of(options, record, heat.omitted_losses);
  if (needs_laser) add_laser(options, heat);
  return heat;
}

void say_case(const HeatCase& heat, Frontend& frontend) {
  frontend.say("material  {}: k {:g} W/(m K), rho c {:.4g} J/(cm3 K), alpha {:.4g} mm2/s",
               heat.material, heat.body.conductivity_w_mmk * 1e3, heat.body.heat_j_mm3k * 1e3,
               heat.body.diffusivity_mm2_s());
  if (!heat.thermal_source.empty()) frontend.say("source    {}", heat.thermal_source);
  if (!heat.omitted_losses.empty())
    frontend.say("omitted   {}", fmt::join(heat.omitted_losses, ", "));
}

void say_losses(const thermal::Losses& losses, double absorbed, Frontend& frontend) {
  const auto percent = [&](double part) { return absorbed > 0 ? 100 * part / absorbed : 0; };
  frontend.say(
      "losses    {:.3g} % of the absorbed: evaporation {:.3g} %, radiation {:.3g} %, "
      "convection {:.3g} %",
      percent(losses.total()), percent(losses.evaporation), percent(losses.radiation),
      percent(losses.convection));
}

void require_balance(const thermal::EnergyBalance& balance) {
  constexpr double max_error = 1e-9;
  if (balance.relative_error() <= max_error) return;
  throw Error(
      Exit::job_failed, "temperature field",
      fmt::format("{:.2g} of the absorbed energy is not accounted for", balance.relative_error()),
      "shorten the time step");
}

}  // namespace lamplock::run
