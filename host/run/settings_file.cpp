#include "host/run/settings_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/job/profile.hpp"
#include "host/job/read_profile.hpp"
#include "host/text.hpp"
#include "shared/units.hpp"

namespace lamplock::run {
namespace {

using settings::Id;

constexpr std::string_view first_axis_suffix = "_x";

/// One setting, or all axes of one as an array.
void add_toml(std::string& text, const link::BoardSettings& board, std::size_t& i) {
  const settings::Row& first = settings::row(static_cast<Id>(i));
  std::string_view name = first.name;
  const bool axes = name.ends_with(first_axis_suffix);
  const std::size_t count = axes ? max_axes : 1;
  std::string values;
  for (std::size_t k = 0; k < count; ++k, ++i) {
    const auto id = static_cast<Id>(i);
    if (!board.has(id)) continue;
    if (!values.empty()) values += ", ";
    values += link::value_text(id, board.values.milli(id));
  }
  if (values.empty()) return;
  if (axes) name.remove_suffix(first_axis_suffix.size());
  text += fmt::format("{} = {}  # {}\n", name, axes ? "[" + values + "]" : values, first.unit);
}

std::string toml_text(const link::BoardSettings& board) {
  std::string text = "# Settings of a board, by `lamplock settings backup`.\n";
  for (std::size_t i = 0; i < settings::setting_count;) add_toml(text, board, i);
  for (const auto& [number, value] : board.texts)
    if (link::find_setting(number) == Id::count)
      text += fmt::format("# ${}={} is not known to this program\n", number, value);
  return text;
}

std::vector<link::Change> from_profile(const std::filesystem::path& file) {
  const job::Profile profile = job::read_profile(file);
  std::vector<link::Change> changes;
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<Id>(i);
    if (profile.stated.test(i))
      changes.push_back(
          {settings::row(id).number, link::value_text(id, profile.settings.milli(id))});
  }
  return changes;
}

/// grbl 0.9 and some senders put a remark in brackets after a setting.
std::string_view without_remark(std::string_view line) {
  return trimmed(line.substr(0, line.find_first_of("(;#")));
}

std::vector<link::Change> from_lines(const std::filesystem::path& file) {
  const std::string whole = read_text_file(file);
  std::string_view text = without_byte_order_mark(whole);
  std::vector<link::Change> changes;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = without_remark(take_line(text));
    if (line.empty() || line == "ok") continue;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    if (!line.starts_with('$'))
      throw Error(Exit::bad_input, where, fmt::format("'{}' is not a setting", line),
                  "write $NUMBER=VALUE, or name the file .toml if it is TOML");
    const link::Change change = link::parse_change(line, where);
    for (const link::Change& before : changes)
      if (before.number == change.number)
        throw Error(Exit::bad_input, where, "the setting is given twice", "keep one of the two");
    changes.push_back(change);
  }
  return changes;
}

}  // namespace

bool is_toml(const std::filesystem::path& file) { return lower_extension(file) == ".toml"; }

std::string backup_text(const link::BoardSettings& board, bool toml) {
  if (toml) return toml_text(board);
  std::string text;
  for (const auto& [number, value] : board.texts) text += fmt::format("${}={}\n", number, value);
  return text;
}

std::vector<link::Change> read_settings_file(const std::filesystem::path& file) {
  std::vector<link::Change> changes = is_toml(file) ? from_profile(file) : from_lines(file);
  if (changes.empty())
    throw Error(Exit::bad_input, file.string(), "has no settings", "is this the right file?");
  return changes;
}

}  // namespace lamplock::run
