#include "host/material/card_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/printable.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::material {
namespace {

/// Reads the keys of one table of a sheet.
class SheetTable {
 public:
  SheetTable(const toml::table& table, const std::filesystem::path& file,
             std::vector<std::string> keys)
      : table_(table), file_(file), keys_(std::move(keys)) {
    for (const auto& [key, node] : table_)
      if (std::find(keys_.begin(), keys_.end(), key.str()) == keys_.end())
        refuse(toml_location(file_, key.source()), fmt::format("unknown key '{}'", key.str()),
               did_you_mean(key.str(), keys_, "use the keys of the sheet as it was made"));
  }

  std::string place() const { return toml_location(file_, table_.source()); }
  std::string text(const char* key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return "";
    if (const auto* value = node->as_string()) return value->get();
    refuse_kind(*node, key, "a text", "write it in quotes");
  }
  /// 0 if the key is missing: not measured.
  double number(const char* key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return 0;
    if (const auto value = node->value<double>(); value && node->is_number()) return *value;
    refuse_kind(*node, key, "a number", "write it without quotes");
  }
  int whole(const char* key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) return 1;
    if (const auto value = node->value<int>(); value && node->is_integer()) return *value;
    refuse_kind(*node, key, "a whole number", "write digits only");
  }

 private:
  [[noreturn]] void refuse_kind(const toml::node& node, const char* key, const char* kind,
                                const char* remedy) const {
    refuse(toml_location(file_, node.source()), fmt::format("'{}' must be {}", key, kind), remedy);
  }

  const toml::table& table_;
  const std::filesystem::path& file_;
  std::vector<std::string> keys_;
};

std::optional<double> unless_zero(double value) {
  return value == 0 ? std::nullopt : std::optional<double>(value);
}

/// What a measurement and a setting of a card have in common.
template <class Record>
Record record_of(const SheetTable& table, const CardSheet& sheet,
                 const std::filesystem::path& file) {
  Record record;
  record.material = sheet.material;
  record.laser = sheet.laser;
  record.thickness_mm = sheet.thickness_mm;
  record.feed_mm_min = table.number("feed_mm_min");
  record.power_w = table.number("power_w");
  record.passes = table.whole("passes");
  record.source = "card " + file.filename().string();
  return record;
}

Measurement read_cut(const SheetTable& table, const CardSheet& sheet,
                     const std::filesystem::path& file) {
  auto cut = record_of<Measurement>(table, sheet, file);
  cut.depth_mm = unless_zero(table.number("depth_mm"));
  cut.result = table.text("result");
  cut.note = table.text("note");
  return cut;
}

Setting read_kerf(const SheetTable& table, const CardSheet& sheet,
                  const std::filesystem::path& file) {
  auto setting = record_of<Setting>(table, sheet, file);
  const int slats = table.whole("slats");
  const double pitch_mm = table.number("pitch_mm"), together_mm = table.number("together_mm");
  if (slats < 1 || !(pitch_mm > 0))
    refuse(table.place(), "'slats' or 'pitch_mm' is missing or 0", "use the sheet as it was made");
  if (together_mm == 0) return setting;
  // Each slat is narrower than the distance of its two cuts by half a kerf at both sides.
  const double kerf_mm = pitch_mm - together_mm / slats;
  if (!(kerf_mm > 0 && kerf_mm < pitch_mm))
    refuse(table.place(),
           fmt::format("'together_mm' is {:g}, without kerf it would be {:g}", together_mm,
                       slats * pitch_mm),
           "give the width of all slats pushed together, in mm");
  // A beam that removes more than it leaves is one that was measured wrongly: one slat instead of
  // all of them.
  if (kerf_mm > pitch_mm / 2)
    refuse(
        table.place(),
        fmt::format("'together_mm' is {:g}: the kerf would be {:g} mm, wider than the slats of "
                    "{:g} mm between its cuts",
                    together_mm, kerf_mm, pitch_mm - kerf_mm),
        "give the width of all slats pushed together, in mm; of a beam so wide, make a card with "
        "a greater pitch");
  setting.kerf_mm = kerf_mm;
  return setting;
}

std::string quoted_name(const std::string& name) { return '"' + name + '"'; }

}  // namespace

std::string sheet_text(const CardRequest& request, const CardLayout& layout, const CardSheet& sheet,
                       const std::string& program) {
  std::string text = fmt::format(
      "# What was measured on the test card {}.\n"
      "# Write the figures here, then: lamplock material measure --card THIS\n"
      "material = {}\nlaser = {}\n",
      printable(program), quoted_name(sheet.material), quoted_name(sheet.laser));
  if (sheet.thickness_mm) text += fmt::format("thickness_mm = {}\n", *sheet.thickness_mm);
  if (request.kind == CardKind::kerf) {
    const CardCut& cut = layout.places.front().cut;
    return text +
           fmt::format(
               "\n[kerf]\nfeed_mm_min = {}\npower_w = {}\npasses = {}\nslats = {}\npitch_mm = {}\n"
               "together_mm = 0    # width of all slats pushed together\n",
               cut.feed_mm_min, cut.power_w, cut.passes, request.slats, request.pitch_mm);
  }
  text +=
      "# depth_mm: depth of the groove after all passes; 0: not measured.\n"
      "# result: \"cut\", \"almost\" or \"not-cut\" for sheets that the cut should go through.\n";
  for (const CardPlace& place : layout.places)
    text += fmt::format(
        "\n[[cut]]\nfeed_mm_min = {}\npower_w = {}\npasses = {}\ndepth_mm = 0\nresult = \"\"\n",
        place.cut.feed_mm_min, place.cut.power_w, place.cut.passes);
  return text;
}

namespace {

/// The figures of a sheet, if there are any.
CardSheet figures_of(const std::filesystem::path& file) {
  const toml::table root = read_toml(file);
  const SheetTable head(root, file, {"material", "laser", "thickness_mm", "cut", "kerf"});
  CardSheet sheet{head.text("material"), head.text("laser"),
                  unless_zero(head.number("thickness_mm"))};
  if (sheet.material.empty()) refuse(file, "'material' is missing", "name the material");
  if (sheet.laser.empty()) refuse(file, "'laser' is missing", "name the laser");
  if (const toml::node* node = root.get("cut")) {
    const toml::array* list = node->as_array();
    if (list == nullptr || !list->is_array_of_tables())
      refuse(toml_location(file, node->source()), "'cut' must be a list of tables",
             "write [[cut]]");
    for (const toml::node& one : *list) {
      const SheetTable table(*one.as_table(), file,
                             {"feed_mm_min", "power_w", "passes", "depth_mm", "result", "note"});
      const Measurement cut = read_cut(table, sheet, file);
      if (!cut.depth_mm && cut.result.empty()) continue;
      check_record(cut, table.place());
      sheet.cuts.push_back(cut);
    }
  }
  if (const toml::node* node = root.get("kerf")) {
    if (!node->is_table())
      refuse(toml_location(file, node->source()), "'kerf' must be a table", "write [kerf]");
    const SheetTable table(
        *node->as_table(), file,
        {"feed_mm_min", "power_w", "passes", "slats", "pitch_mm", "together_mm"});
    const Setting setting = read_kerf(table, sheet, file);
    check_record(setting, table.place());
    if (setting.kerf_mm) sheet.kerf = setting;
  }
  return sheet;
}

bool has_figures(const CardSheet& sheet) { return !sheet.cuts.empty() || sheet.kerf; }

}  // namespace

CardSheet read_sheet(const std::filesystem::path& file) {
  CardSheet sheet = figures_of(file);
  if (!has_figures(sheet))
    refuse(file, "it has no measured figure", "write the measured figures in place of the zeros");
  return sheet;
}

bool is_unused_sheet(const std::filesystem::path& file) {
  try {
    return !has_figures(figures_of(file));
  } catch (const Error&) {
    return false;
  }
}

}  // namespace lamplock::material
