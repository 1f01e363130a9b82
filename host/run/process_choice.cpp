#include "host/run/process_choice.hpp"

#include <fmt/format.h>

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/link/program_lines.hpp"
#include "host/material/cut_setting.hpp"
#include "host/number_text.hpp"
#include "host/program/process_values.hpp"
#include "host/run/material_records.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {
namespace {

void require_material(const ProcessChoice& choice) {
  const std::array<std::pair<const char*, bool>, 4> parts{
      {{"--laser", choice.laser.has_value()},
       {"--thickness", choice.thickness_mm.has_value()},
       {"--operation", choice.operation.has_value()},
       {"--library", !choice.library.empty()}}};
  for (const auto& [name, is_given] : parts)
    if (is_given)
      throw Error(Exit::bad_input, name, "is part of the choice of a material",
                  "add --material NAME or leave it out");
}

std::string title_of(const material::CutSetting& setting) {
  std::string title = setting.material;
  if (setting.thickness_mm) title += fmt::format(", {} mm", number_text(*setting.thickness_mm));
  return title + fmt::format(", {}, laser {}", setting.operation, setting.laser);
}

std::string edit_of(const material::CutSetting& setting, const std::string& library) {
  std::vector<std::string> words{
      "lamplock", "material", "edit",     setting.material,
      "--kind",   "setting",  "--number", fmt::format("{}", setting.number)};
  if (!library.empty()) words.insert(words.end(), {"--library", library});
  return shell_text(words);
}

}  // namespace

std::optional<program_run::ProcessValues> process_values(const ProcessChoice& choice) {
  if (!choice.material) {
    require_material(choice);
    return std::nullopt;
  }
  material::Library library = library_for_reading(choice.library);
  material::CutQuery query{*choice.material, choice.laser.value_or(""), choice.thickness_mm};
  if (choice.operation) query.operation = *choice.operation;
  const material::CutSetting setting = material::cut_setting(library, query);
  return program_run::ProcessValues{
      .title = title_of(setting),
      .edit = edit_of(setting, choice.library),
      .feed_mm_min = setting.feed_mm_min,
      .power_w = setting.power_w,
      .power_share = setting.power_share,
      .passes = setting.passes,
      .air = setting.air,
      .kerf_mm = setting.kerf_mm,
      .thickness_mm = setting.thickness_mm,
      .frequency_hz = setting.frequency_hz,
  };
}

std::string unused_choice_note(const std::string& file, const std::string& text,
                               const std::vector<link::ProgramLine>& lines) {
  if (program_run::has_process_values(text)) return {};
  std::set<std::string> called;
  for (const link::ProgramLine& line : lines)
    if (const auto colon = line.origin.rfind(':'); colon != std::string::npos)
      called.insert(line.origin.substr(0, colon));
  for (const std::string& other : called)
    if (program_run::has_process_values(read_file(other))) return {};
  return fmt::format(
      "note: {}: the program reads no value of the material, so --material has no effect; it reads "
      "them by names such as #<_material_feed>",
      file);
}

std::string text_of(const program_run::ProcessValues& values) {
  std::string text =
      fmt::format("{}: {} mm/min, {} W, {}", values.title, number_text(values.feed_mm_min),
                  number_text(values.power_w),
                  count_text(static_cast<std::size_t>(values.passes), "pass", "passes"));
  if (values.kerf_mm) text += fmt::format(", kerf {} mm", number_text(*values.kerf_mm));
  if (values.frequency_hz) text += fmt::format(", {} Hz", number_text(*values.frequency_hz));
  return values.air ? text + ", air" : text;
}

}  // namespace lamplock::run
