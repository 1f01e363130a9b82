#include "host/run/material_card.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/cutting/operation.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/output_files.hpp"
#include "host/file/staged_file.hpp"
#include "host/material/card_sheet.hpp"
#include "host/program/program_run.hpp"
#include "host/run/material_records.hpp"
#include "host/run/sent_file.hpp"
#include "host/suggestion.hpp"
#include "host/text.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using material::Laser;
using material::Library;
using settings::Id;

constexpr const char* card_where = "test card";
/// Feeds of the depth model's source, mm/min.
constexpr const char* source_feeds = "30,45,60,90,120,180,240,300,360,420,600";
/// Labels are light: half of the power at the source's fastest feed.
constexpr double default_label_feed_mm_min = 600;
constexpr const char* default_label_power = "50%";

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

[[noreturn]] void refuse_list(const std::string& where, const std::string& part) {
  throw Error(Exit::bad_input, where, fmt::format("'{}' is neither a number nor a range", part),
              "give numbers, or FROM:TO:COUNT: 30,60,120 or 30:600:10");
}

double list_number(const std::string& text, const std::string& where) {
  const auto value = number_of<double>(text);
  if (!value || !std::isfinite(*value) || !(*value > 0)) refuse_list(where, text);
  return *value;
}

/// As many digits as in the program, so that labels are short.
double to_thousandths(double value) {
  constexpr double thousandths = 1000;
  return std::round(value * thousandths) / thousandths;
}

/// FROM:TO:COUNT; of whole numbers also FROM:TO.
void add_range(const std::vector<std::string>& ends, const std::string& part,
               const std::string& where, ListNumbers kind, std::vector<double>& numbers) {
  const double from = list_number(ends[0], where), to = list_number(ends[1], where);
  const bool has_count = ends.size() == 3;
  if (!has_count && kind != ListNumbers::whole)
    throw Error(Exit::bad_input, where, fmt::format("'{}' has no count", part),
                fmt::format("give FROM:TO:COUNT, as {}:10", part));
  if (!has_count && (std::floor(from) != from || std::floor(to) != to)) refuse_list(where, part);
  const double count = has_count ? list_number(ends[2], where) : std::abs(to - from) + 1;
  if (std::floor(count) != count || count > static_cast<double>(material::max_card_cuts) ||
      (count < 2 && from != to))
    throw Error(
        Exit::bad_input, where, fmt::format("'{}' has an invalid COUNT", part),
        fmt::format("give FROM:TO:COUNT with a whole COUNT, 2 to {}", material::max_card_cuts));
  const int values = static_cast<int>(count);
  for (int i = 0; i < values; ++i) {
    const double value = values == 1 ? from : from + (to - from) * i / (values - 1);
    numbers.push_back(to_thousandths(value));
  }
}

/// Powers in W, each of a list or range in W or percent.
std::vector<double> power_list(const std::string& text, const Laser& laser) {
  std::vector<double> powers;
  const bool is_percent = text.find('%') != std::string::npos;
  std::string plain;
  for (const char c : text)
    if (c != '%') plain += c;
  for (const double value : number_list(plain, "powers")) {
    const double power_w =
        power_w_of(fmt::format("{}{}", value, is_percent ? "%" : ""), laser, "powers");
    const double rounded_w = to_thousandths(power_w);
    powers.push_back(rounded_w > 0 ? rounded_w : power_w);
  }
  return powers;
}

std::vector<int> pass_list(const std::string& text) {
  constexpr double max_passes_of_card = 100;
  std::vector<int> passes;
  for (const double value : number_list(text, "passes", ListNumbers::whole)) {
    if (std::floor(value) != value || value > max_passes_of_card)
      throw Error(Exit::bad_input, "passes",
                  fmt::format("{:g} is not a valid number of passes", value),
                  fmt::format("give whole numbers, 1 to {:g}", max_passes_of_card));
    passes.push_back(static_cast<int>(value));
  }
  return passes;
}

material::CardKind kind_named(const std::string& name) {
  if (name == "depth") return material::CardKind::depth;
  if (name == "grid") return material::CardKind::grid;
  if (name == "kerf") return material::CardKind::kerf;
  throw Error(Exit::bad_input, card_where, fmt::format("'{}' is not a kind of card", name),
              did_you_mean(name, {"depth", "grid", "kerf"}, "give depth, grid or kerf"));
}

/// Throws for a machine without a continuous laser, whose power a program sets.
void require_continuous_laser(const CardOptions& options, const job::Profile& profile) {
  if (profile.settings.whole(Id::laser_mode) != 0) return;
  throw Error(
      Exit::bad_input, options.machine.machine.empty() ? "machine" : options.machine.machine,
      "it is a machine with a pulsed laser (laser_mode = 0), a test card needs a continuous "
      "one",
      "give the profile of a machine with laser_mode = 1, as examples/laser.toml is");
}

material::CardRequest request_of(const CardOptions& options, const Laser& laser,
                                 const job::Profile& profile) {
  const settings::Values& values = profile.settings;
  material::CardRequest request;
  request.kind = kind_named(options.kind);
  request.title = fmt::format("test card: {} with {}", options.material, laser.name);
  const bool is_comb = request.kind == material::CardKind::kerf;
  request.feeds_mm_min = number_list(options.feeds.empty() ? source_feeds : options.feeds, "feeds");
  if (options.feeds.empty() && is_comb)
    throw Error(Exit::bad_input, card_where, "the feed of the comb is not given",
                "give one feed, one power and one number of passes that cut through");
  request.powers_w = power_list(options.powers.empty() ? "100%" : options.powers, laser);
  request.passes = pass_list(options.passes.empty() ? "1" : options.passes);
  request.laser = laser;
  request.full_power_s = in_units(values, Id::max_spindle_speed);
  request.label_feed_mm_min = options.label_feed_mm_min.value_or(default_label_feed_mm_min);
  request.label_power_w =
      power_w_of(options.label_power.empty() ? default_label_power : options.label_power, laser,
                 "label power");
  request.air = options.air;
  request.cell_mm = options.cell_mm;
  request.slats = options.slats;
  request.pitch_mm = options.pitch_mm;
  request.slat_length_mm = options.slat_length_mm;
  request.max_width_mm = in_units(values, Id::travel_x, 0);
  request.max_height_mm = in_units(values, Id::travel_x, 1);
  const double max_feed_mm_min =
      std::min(in_units(values, Id::max_rate_x, 0), in_units(values, Id::max_rate_x, 1));
  const double slowest_mm_min =
      std::min(request.label_feed_mm_min, *std::ranges::min_element(request.feeds_mm_min));
  if (slowest_mm_min < cutting::min_feed_mm_min)
    throw Error(
        Exit::bad_input, "feeds",
        fmt::format("{:g} mm/min is less than {:g}", slowest_mm_min, cutting::min_feed_mm_min),
        "give a faster feed");
  for (const double feed : request.feeds_mm_min)
    if (feed > max_feed_mm_min)
      throw Error(Exit::bad_input, "feeds",
                  fmt::format("{:g} mm/min is more than the machine's {:g}", feed, max_feed_mm_min),
                  "give a slower feed");
  return request;
}

/// The beam leaves something between the cuts: of a kerf card slats that are at least as wide as
/// it, as its sheet needs them.
void require_room(const material::CardRequest& request) {
  const double beam_mm = request.laser.beam_width_mm;
  const auto refuse_below = [&](double size_mm, double min_mm, const char* what) {
    if (size_mm >= min_mm) return;
    throw Error(
        Exit::bad_input, card_where,
        fmt::format("{} of {:g} mm is too small for the beam of {:g} mm", what, size_mm, beam_mm),
        fmt::format("give at least {:g} mm", min_mm));
  };
  if (request.kind == material::CardKind::kerf)
    refuse_below(request.pitch_mm, 2 * beam_mm, "a pitch");
  if (request.kind == material::CardKind::grid)
    refuse_below(request.cell_mm, 2 * beam_mm, "a cell");
}

/// The lower left corner of the card in machine coordinates.
std::pair<double, double> corner_of(const CardOptions& options, const material::CardLayout& layout,
                                    const settings::Values& values) {
  if (options.corner_mm.size() == 2) return {options.corner_mm[0], options.corner_mm[1]};
  const auto middle = [&](int axis, double size_mm) {
    return in_units(values, Id::min_corner_x, axis) +
           (in_units(values, Id::travel_x, axis) - size_mm) / 2;
  };
  return {middle(0, layout.width_mm), middle(1, layout.height_mm)};
}

/// Runs the program in the firmware's interpreter.
double checked_seconds(const std::string& program, const settings::Values& values) {
  const program_run::ProgramRun run = program_run::run_program(program, values, 1);
  if (!run.problems.empty())
    throw Error(Exit::bad_input, card_where,
                fmt::format("the machine refuses line {} of its program: {}", run.problems[0].line,
                            run.problems[0].text),
                "check the place of the card and the machine profile");
  if (run.outside != 0)
    throw Error(Exit::bad_input, card_where, "it lies outside the work space of the machine",
                "choose another place, or make the card smaller");
  return run.seconds();
}

}  // namespace

std::vector<double> number_list(const std::string& text, const std::string& where,
                                ListNumbers kind) {
  std::vector<double> numbers;
  for (const std::string& part : parts_of(text, ',')) {
    const std::vector<std::string> ends = parts_of(part, ':');
    if (ends.size() == 1)
      numbers.push_back(list_number(part, where));
    else if (ends.size() <= 3)
      add_range(ends, part, where, kind, numbers);
    else
      refuse_list(where, part);
  }
  return numbers;
}

CardResult make_card(const CardOptions& options) {
  Library library = library_for_reading(options.library);
  const material::Material material = library.material(options.material);
  const Laser laser = laser_of(library, options);
  const job::Profile profile = options.machine.profile();
  require_continuous_laser(options, profile);
  const material::CardRequest request = request_of(options, laser, profile);
  require_room(request);
  const material::CardLayout layout = lay_out_card(request);
  const std::optional<double> thickness_mm =
      options.thickness_mm ? options.thickness_mm : material.thickness_mm;
  // The kerf becomes part of a setting; one without a thickness would be for any.
  if (request.kind == material::CardKind::kerf && !thickness_mm)
    throw Error(Exit::bad_input, title_of(material), "its thickness is not known",
                "give the thickness of the sheet in mm");
  const auto [x_mm, y_mm] = corner_of(options, layout, profile.settings);
  const std::string program = card_program(request, layout, x_mm, y_mm);
  CardResult result{layout.places.size(), layout.width_mm, layout.height_mm,
                    checked_seconds(program, profile.settings), options.sheet};
  check_program_name(options.output);
  if (result.sheet.empty())
    result.sheet = std::filesystem::path(options.output).replace_extension(".toml").string();
  check_distinct({{"the program", options.output}, {"the sheet", result.sheet}},
                 {options.machine.machine, library_file(options.library)});
  const std::string sheet = sheet_text(request, layout, {material.name, laser.name, thickness_mm},
                                       std::filesystem::path(options.output).filename().string());
  check_target(result.sheet);
  // The user's figures are not replaced, nor another file of this name.
  std::error_code failure;
  if (std::filesystem::is_regular_file(result.sheet, failure) &&
      !material::is_unused_sheet(result.sheet))
    throw Error(Exit::bad_input, result.sheet,
                "it has measured figures, or is not a sheet of a test card",
                "name the card or its sheet differently, or remove the file");
  // Both or neither.
  StagedFile staged_program(options.output), staged_sheet(result.sheet);
  write_file(staged_program.path(), program);
  write_file(staged_sheet.path(), sheet);
  staged_program.commit();
  staged_sheet.commit();
  return result;
}

CardFigures measure_card(const CutChoice& choice, const std::string& sheet_file) {
  const material::CardSheet sheet = material::read_sheet(sheet_file);
  const auto require_same = [&](const std::string& given, const std::string& in_sheet) {
    if (!given.empty() && given != in_sheet)
      throw Error(Exit::bad_input, sheet_file, fmt::format("it is the sheet of {}", in_sheet),
                  fmt::format("give {}, or the sheet of {}", in_sheet, given));
  };
  require_same(choice.material, sheet.material);
  require_same(choice.laser, sheet.laser);
  CardFigures figures{sheet.material, sheet.laser};
  change_library(choice.library, [&](Library& library) {
    (void)library.material(sheet.material);
    (void)library.laser(sheet.laser);
    const material::ImportCount count = library.import_records({{}, {}, {}, sheet.cuts}, false);
    figures.added = count.added;
    figures.unchanged = count.unchanged;
    if (!sheet.kerf) return;
    figures.kerf_mm = sheet.kerf->kerf_mm;
    for (material::Setting setting : library.settings_of(sheet.material))
      if (setting.laser == sheet.laser && setting.operation == sheet.kerf->operation &&
          setting.thickness_mm == sheet.kerf->thickness_mm) {
        setting.kerf_mm = sheet.kerf->kerf_mm;
        library.replace(setting);
        return;
      }
    library.add(*sheet.kerf);
  });
  return figures;
}

}  // namespace lamplock::run
