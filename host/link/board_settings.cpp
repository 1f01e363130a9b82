#include "host/link/board_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "host/error.hpp"
#include "host/former_names.hpp"
#include "host/job/rate_excess.hpp"
#include "host/job/setting_range.hpp"
#include "host/link/not_ready.hpp"
#include "host/suggestion.hpp"
#include "host/text.hpp"
#include "host/units.hpp"
#include "shared/settings_text.hpp"

namespace lamplock::link {
namespace {

using settings::Id;

std::string command(std::uint32_t number, std::string_view value) {
  return fmt::format("${}={}", number, value);
}

[[noreturn]] void refuse_value(const settings::Row& row, std::string_view value,
                               const std::string& where, GcodeError error) {
  if (error == GcodeError::setting_out_of_range)
    throw Error(Exit::bad_input, where, fmt::format("{} = {} is out of range", row.name, value),
                job::setting_range(row));
  throw Error(
      Exit::bad_input, where, fmt::format("{} = '{}' is not a number", row.name, value),
      row.unit == "on/off" ? job::setting_range(row) : "write digits with up to three decimals");
}

/// Checks the value of a setting that the table does not have: printable, without bytes that are
/// commands to a board.
void check_unknown(std::uint32_t number, std::string_view value, const std::string& where) {
  const bool plain = !value.empty() && std::all_of(value.begin(), value.end(), [](char c) {
    return c >= ' ' && c < 0x7F && !wire::is_realtime(static_cast<std::uint8_t>(c));
  });
  if (!plain)
    throw Error(Exit::bad_input, where,
                fmt::format("'{1}' is not a valid value for ${0}", number, value),
                "use the form that $$ shows");
}

/// Compares values, not their spelling.
bool has_value(const BoardSettings& board, const Change& change) {
  const std::string& text = board.texts.at(change.number);
  const settings::SettingLine ours = settings::read_setting(command(change.number, change.text));
  const settings::SettingLine theirs = settings::read_setting(command(change.number, text));
  if (ours.error == GcodeError::none && theirs.error == GcodeError::none)
    return ours.milli == theirs.milli;
  const auto one = number_of<double>(text), other = number_of<double>(change.text);
  return one && other ? *one == *other : text == change.text;
}

/// Sends changes, and refused ones again, until none is left or all of the rest are refused.
/// Returns the refused ones with their last error.
std::vector<std::pair<Change, int>> send_changes(LinePort& port, std::vector<Change> changes,
                                                 std::vector<Change>& taken) {
  for (;;) {
    std::vector<std::pair<Change, int>> refused;
    for (const Change& change : changes)
      if (const int error = ask(port, command(change.number, change.text)).error; error != 0)
        refused.emplace_back(change, error);
      else
        taken.push_back(change);
    if (refused.empty() || refused.size() == changes.size()) return refused;
    changes.clear();
    for (const auto& [change, error] : refused) changes.push_back(change);
  }
}

/// Why the board may have refused one of these changes, and what to do.
std::pair<std::string, std::string> refusal_words(LinePort& port, const BoardSettings& before,
                                                  const std::vector<Change>& changes,
                                                  const Change& refused, int error) {
  if (error == static_cast<int>(GcodeError::not_idle)) {
    const BoardStatus status = greet(port).status;
    const std::string& board = port.transport().board();
    return {error_text(error),
            status.rests() ? "try again" : why_not_ready(status, board, Homing::unknown).remedy};
  }
  settings::Values values = before.values;
  for (const Change& change : changes) {
    const settings::SettingLine line = settings::read_setting(command(change.number, change.text));
    if (line.error == GcodeError::none) values.set_milli(line.id, line.milli);
  }
  // Its range has been checked: the board, or its pin map, lacks the input.
  if (error == static_cast<int>(GcodeError::setting_out_of_range) &&
      refused.number == settings::row(settings::Id::loop).number && refused.text != "0")
    return {"the board has no SENSOR with this pin map",
            "leave it out, or choose a board that has the input: docs/thermal.md"};
  const auto excess = job::rate_excess_words(values);
  if (excess && error == static_cast<int>(GcodeError::step_rate_too_high))
    return {excess->limit, excess->remedy};
  return {error_text(error), "choose a value that fits the other settings"};
}

}  // namespace

bool take_setting(std::string_view line, BoardSettings& settings) {
  const auto equals = line.find('=');
  if (!line.starts_with('$') || equals == std::string_view::npos) return false;
  const auto number = number_of<std::uint32_t>(line.substr(1, equals - 1));
  if (!number) return false;
  settings.texts[*number] = line.substr(equals + 1);
  const settings::SettingLine row = settings::read_setting(line);
  if (row.error == GcodeError::none && settings.values.set_milli(row.id, row.milli))
    settings.known.set(static_cast<std::size_t>(row.id));
  return true;
}

BoardSettings read_settings(LinePort& port, const Patience& patience) {
  const Answer answer = ask(port, "$$", patience);
  if (answer.error != 0)
    throw Error(Exit::job_failed, "machine", "refuses $$: " + error_text(answer.error),
                "wait until it is idle and try again");
  BoardSettings settings;
  for (const std::string& line : answer.lines) take_setting(line, settings);
  return settings;
}

std::uint32_t number_of_setting(std::string_view name, const std::string& where) {
  name = trimmed(name);
  const std::string_view present = present_name(name);
  if (const Id id = settings::find_name(present); id != Id::count) {
    if (present != name) note_former_name(where, name);
    return settings::row(id).number;
  }
  std::string_view digits = name;
  if (digits.starts_with('$')) digits.remove_prefix(1);
  const auto number = number_of<std::uint32_t>(digits);
  // Another spelling, as 00 of 0, is a slip: of 100, perhaps.
  if (number && fmt::format("{}", *number) == digits) return *number;
  throw Error(Exit::bad_input, where,
              number ? fmt::format("'{}' has leading zeros", name)
                     : fmt::format("there is no setting '{}'", name),
              number ? fmt::format("give {}, if that is the setting that is meant", *number)
                     : did_you_mean(name, setting_names(),
                                    "lamplock settings list shows their names and numbers"));
}

std::vector<std::string> setting_names() {
  std::vector<std::string> names;
  for (const settings::Row& row : settings::table) names.emplace_back(row.name);
  return names;
}

Id find_setting(std::uint32_t number) {
  if (number > std::numeric_limits<std::uint16_t>::max()) return Id::count;
  return settings::find_number(static_cast<std::uint16_t>(number));
}

std::string setting_name(std::uint32_t number) {
  const Id id = find_setting(number);
  return id == Id::count ? fmt::format("${}", number)
                         : fmt::format("${} {}", number, settings::row(id).name);
}

std::string value_text(Id id, std::int32_t milli) {
  constexpr std::int32_t milli_per_whole = 1000;
  if (settings::row(id).whole) return fmt::format("{}", milli / milli_per_whole);
  return fmt::format("{:.3f}", milli / milli_per_unit);
}

Change parse_change(std::string_view text, const std::string& where) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos)
    throw Error(Exit::bad_input, where, fmt::format("'{}' has no value", text),
                "write NAME=VALUE or NUMBER=VALUE");
  const std::string_view name = trimmed(text.substr(0, equals));
  const std::string_view value = trimmed(text.substr(equals + 1));
  const std::uint32_t number = number_of_setting(name, where);
  const Id id = find_setting(number);
  if (id == Id::count) {
    check_unknown(number, value, where);
    return {number, std::string(value)};
  }
  const settings::SettingLine line = settings::read_setting(command(number, value));
  if (line.error != GcodeError::none) refuse_value(settings::row(id), value, where, line.error);
  return {number, value_text(id, line.milli)};
}

std::vector<Change> differing(const BoardSettings& board, const std::vector<Change>& wanted) {
  std::vector<Change> result;
  for (const Change& change : wanted) {
    if (!board.texts.contains(change.number))
      throw Error(Exit::bad_input, setting_name(change.number), "the board has no such setting",
                  "leave it out");
    if (!has_value(board, change)) result.push_back(change);
  }
  return result;
}

std::vector<Change> without_missing_defaults(const BoardSettings& board,
                                             std::vector<Change> wanted) {
  std::erase_if(wanted, [&](const Change& change) {
    const Id id = find_setting(change.number);
    return id != Id::count && !board.texts.contains(change.number) &&
           change.text == value_text(id, settings::row(id).default_milli);
  });
  return wanted;
}

BoardSettings change_settings(LinePort& port, const BoardSettings& before,
                              const std::vector<Change>& changes) {
  std::vector<Change> taken;
  const auto refused = send_changes(port, changes, taken);
  if (!refused.empty()) {
    std::vector<Change> back, ignored;
    for (auto change = taken.rbegin(); change != taken.rend(); ++change)
      back.push_back({change->number, before.texts.at(change->number)});
    const bool restored = send_changes(port, back, ignored).empty();
    const auto& [change, error] = refused.front();
    const auto [reason, remedy] = refusal_words(port, before, changes, change, error);
    throw Error(Exit::job_failed, setting_name(change.number),
                fmt::format("the board refuses {}: {}; {}", change.text, reason,
                            restored ? "nothing was changed" : "some settings were changed"),
                remedy);
  }
  BoardSettings after = read_settings(port);
  for (const Change& change : changes)
    if (!after.texts.contains(change.number) || !has_value(after, change))
      throw Error(Exit::job_failed, setting_name(change.number),
                  fmt::format("was set to {} but has another value", change.text),
                  "list the settings and try again");
  return after;
}

}  // namespace lamplock::link
