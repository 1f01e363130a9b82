// The settings of a board: read by `$$`, changed by `$number=value`, all or none.
//
// In:  a port; changes as text. Out: the settings of the board, known to this program or not; the
//      changes, made and read back.
// Who: `settings`; `send`, to estimate the duration of a program.
//
// All changes are checked against the table before the first one is sent. A board may still refuse
// a value that contradicts another setting: refused changes are sent again after the others, and if
// the board still refuses one, all changes are undone.
#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/dialog.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::link {

/// Settings as a board reports them.
struct BoardSettings {
  std::map<std::uint32_t, std::string> texts;  ///< all, by number, as the board writes them
  settings::Values values;                     ///< those of the table; others at their default
  std::bitset<settings::setting_count> known;  ///< rows of the table that the board has reported

  bool has(settings::Id id) const { return known.test(static_cast<std::size_t>(id)); }
};

/// Reads a line of `$$`, "$100=200.000"; false if the line is another one. A value that the table
/// does not allow is stored as text only.
bool take_setting(std::string_view line, BoardSettings& settings);

/// Asks for all settings. Throws Error: no_device (no answer), job_failed (refused: not at rest).
BoardSettings read_settings(LinePort& port, const Patience& patience = {});

/// A setting and its new value, as it is sent.
struct Change {
  std::uint32_t number = 0;
  std::string text;
};

/// Row of a setting; Id::count if the table has none with this number.
settings::Id find_setting(std::uint32_t number);
/// The number of a setting given by number, $number, name or former name. `where` is for errors and
/// for the note about a former name. Throws Error(bad_input) for other texts, such as 00.
std::uint32_t number_of_setting(std::string_view name, const std::string& where);

/// The names of all settings, in the order of their numbers.
std::vector<std::string> setting_names();

/// "120 acceleration_x", or the number alone.
std::string setting_name(std::uint32_t number);
/// A value as a board writes it: whole or with three decimals.
std::string value_text(settings::Id id, std::int32_t milli);

/// Reads "NAME=VALUE". Throws Error(bad_input) about `where` if there is no such setting or the
/// table does not allow the value. Numbers that the table does not have are accepted unchecked.
Change parse_change(std::string_view text, const std::string& where);

/// The wanted values of a file without those that the board does not have, where they are defaults:
/// the file may be of a board with more settings.
std::vector<Change> without_missing_defaults(const BoardSettings& board,
                                             std::vector<Change> wanted);

/// The wanted changes that differ from the board's values. Throws Error(bad_input) for settings
/// that the board does not have.
std::vector<Change> differing(const BoardSettings& board, const std::vector<Change>& wanted);

/// Makes the changes and reads them back; `before` has the board's present values. Throws Error:
/// no_device, job_failed (refused; the changes are undone).
BoardSettings change_settings(LinePort& port, const BoardSettings& before,
                              const std::vector<Change>& changes);

}  // namespace lamplock::link
