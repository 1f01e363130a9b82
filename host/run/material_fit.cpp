#include "host/run/material_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/run/material_records.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

using material::Laser;
using material::Library;
using material::Material;
using material::Measurement;

/// A material, its laser and what that laser measured.
struct CutRecords {
  Material material;
  Laser laser;
  std::vector<Measurement> measurements{};
};

CutRecords records_of(Library& library, const CutChoice& choice) {
  CutRecords records{library.material(choice.material), laser_of(library, choice)};
  for (const Measurement& one : library.measurements_of(choice.material))
    if (one.laser == records.laser.name) records.measurements.push_back(one);
  return records;
}

double thickness_of(const Material& material, std::optional<double> given_mm) {
  if (given_mm) return *given_mm;
  if (material.thickness_mm) return *material.thickness_mm;
  throw Error(Exit::bad_input, title_of(material), "its thickness is not known",
              "give a thickness in mm");
}

}  // namespace

Laser laser_of(Library& library, const CutChoice& choice) {
  if (!choice.laser.empty()) return library.laser(choice.laser);
  std::set<std::string> names;
  for (const Measurement& one : library.measurements_of(choice.material)) names.insert(one.laser);
  if (names.empty())
    for (const material::Setting& one : library.settings_of(choice.material))
      names.insert(one.laser);
  if (names.empty())
    for (const Laser& one : library.all<Laser>()) names.insert(one.name);
  if (names.size() == 1) return library.laser(*names.begin());
  throw Error(Exit::bad_input, "material " + choice.material,
              names.empty() ? "the library has no laser" : "it is not clear which laser is meant",
              names.empty() ? "add one" : fmt::format("name it: {}", fmt::join(names, ", ")));
}

double power_w_of(const std::string& text, const Laser& laser, const std::string& where) {
  if (text.empty()) return laser.power_w;
  std::string_view digits = text;
  const bool is_percent = digits.ends_with('%');
  if (is_percent) digits.remove_suffix(1);
  const auto value = number_of<double>(digits);
  if (!value || !(*value > 0))
    throw Error(Exit::bad_input, where, fmt::format("the power is '{}'", text),
                "give W, or percent of the laser's power: 50%");
  const double power_w = is_percent ? *value / 100 * laser.power_w : *value;
  if (!(power_w <= laser.power_w))
    throw Error(
        Exit::bad_input, where,
        fmt::format("the power is {:g} W, more than that of the laser {}", power_w, laser.name),
        fmt::format("give at most {:g} W", laser.power_w));
  return power_w;
}

Measurement measure(const MeasureRequest& request) {
  Measurement stored;
  change_library(request.library, [&](Library& library) {
    const Material material = library.material(request.material);
    const Laser laser = laser_of(library, request);
    stored = {};
    stored.material = material.name;
    stored.laser = laser.name;
    stored.feed_mm_min = request.feed_mm_min.value_or(0);
    stored.power_w = power_w_of(request.power, laser, title_of(stored));
    stored.passes = request.passes;
    stored.depth_mm = request.depth_mm;
    stored.thickness_mm = request.thickness_mm ? request.thickness_mm : material.thickness_mm;
    stored.result = request.result;
    if (!stored.result.empty() && !stored.thickness_mm)
      throw Error(Exit::bad_input, title_of(stored), "'thickness_mm' is missing",
                  "give the thickness of the sheet");
    stored.note = request.note;
    stored.source = "own measurement";
    stored = library.add(stored);
  });
  return stored;
}

FitResult fit_material(const CutChoice& choice, material::Rejected rejected) {
  Library library = library_for_reading(choice.library);
  CutRecords records = records_of(library, choice);
  material::MaterialFit fit =
      material::fit_material(records.laser, records.material, records.measurements, rejected);
  return {records.laser, records.material, fit};
}

BestResult best_cut(const CutChoice& choice, std::optional<double> thickness_mm, double length_mm,
                    material::Rejected rejected) {
  Library library = library_for_reading(choice.library);
  CutRecords records = records_of(library, choice);
  const double thickness = thickness_of(records.material, thickness_mm);
  const material::BestCut best =
      material::best_cut(records.material, records.measurements, thickness, length_mm, rejected);
  return {records.laser, records.material, thickness, best};
}

SuitableResult judge_material(const CutChoice& choice, const material::Trial& trial,
                              std::optional<double> thickness_mm, double length_mm) {
  Library library = library_for_reading(choice.library);
  CutRecords records = records_of(library, choice);
  SuitableResult result{records.laser, records.material};
  result.is_by_trial = trial.passes || trial.groove_mm;
  if (thickness_mm || records.material.thickness_mm || !result.is_by_trial)
    result.thickness_mm = thickness_of(records.material, thickness_mm);
  result.suitability = judge(result.is_by_trial ? trial
                                                : trial_of(records.material, records.measurements,
                                                           result.thickness_mm.value_or(0)));
  if (result.suitability.verdict != material::Verdict::cutting) return result;
  // The second stage needs more than the first one; what is missing is not an error here.
  try {
    result.fit = material::fit_material(records.laser, records.material, records.measurements,
                                        material::Rejected::left_out);
  } catch (const Error&) {
    result.fit.reset();
  }
  try {
    if (result.thickness_mm)
      result.best = material::best_cut(records.material, records.measurements, *result.thickness_mm,
                                       length_mm, material::Rejected::left_out);
  } catch (const Error&) {
    result.best.reset();
  }
  return result;
}

}  // namespace lamplock::run
