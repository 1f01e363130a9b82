#include "host/run/cut_material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/material/cut_setting.hpp"
#include "host/number_text.hpp"
#include "host/run/material_records.hpp"

namespace lamplock::run {
namespace {

bool needs_values(const OperationChoice& choice) {
  return choice.material && !choice.is_off && choice.kind != "ignore";
}

void require_material(const OperationChoice& choice, const std::string& name) {
  if (choice.material || (!choice.laser && !choice.thickness_mm)) return;
  throw Error(Exit::bad_input, name,
              choice.laser ? "a laser is given without a material"
                           : "a thickness is given without a material",
              "give the name of a material: lamplock material list");
}

/// What is not given is that of the setting. The width of the groove compensates cuts alone, and
/// passes with a depth each are the user's.
void fill(OperationChoice& choice, const material::CutSetting& setting) {
  constexpr double percent = 100;
  if (!choice.power_percent) choice.power_percent = percent * setting.power_share;
  if (!choice.feed_mm_min) choice.feed_mm_min = setting.feed_mm_min;
  if (!choice.passes && !choice.infeed_mm) choice.passes = setting.passes;
  if (!choice.kerf_mm && choice.kind == "cut") choice.kerf_mm = setting.kerf_mm;
  choice.has_air = choice.has_air || setting.air;
}

std::string setting_text(const OperationChoice& choice, const material::CutSetting& setting) {
  std::string text = setting.material;
  if (setting.thickness_mm) text += fmt::format(", {} mm", number_text(*setting.thickness_mm));
  text += fmt::format(", laser {}: {} %, {} mm/min", setting.laser,
                      number_text(choice.power_percent.value_or(0)),
                      number_text(choice.feed_mm_min.value_or(0)));
  if (choice.passes)
    text += fmt::format(", {} {}", *choice.passes, *choice.passes == 1 ? "pass" : "passes");
  if (choice.kerf_mm) text += fmt::format(", kerf {} mm", number_text(*choice.kerf_mm));
  return choice.has_air ? text + ", air" : text;
}

}  // namespace

CutDescription with_materials(CutDescription description, const std::string& library_file,
                              Frontend& frontend) {
  std::vector<OperationChoice>& choices = description.operations;
  for (std::size_t i = 0; i < choices.size(); ++i)
    require_material(choices[i], operation_name(choices[i], i));
  if (!library_file.empty() && std::ranges::none_of(choices, [](const OperationChoice& one) {
        return one.material.has_value();
      }))
    throw Error(Exit::bad_input, "--library", "has no effect without a material",
                "give --material, or leave it out");
  if (std::ranges::none_of(choices, needs_values)) return description;
  material::Library library = library_for_reading(library_file);
  for (OperationChoice& choice : choices) {
    if (!needs_values(choice)) continue;
    const material::CutSetting setting = material::cut_setting(
        library, {*choice.material, choice.laser.value_or(""), choice.thickness_mm, choice.kind});
    fill(choice, setting);
    frontend.say("material {}", setting_text(choice, setting));
  }
  return description;
}

}  // namespace lamplock::run
