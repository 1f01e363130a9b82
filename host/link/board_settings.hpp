// The settings of a board: read by `$$`, changed by `$number=value`, all or none.
//
// In:  a port; what somebody wants changed, in words. Out: what the board keeps, known to this
//      program or not; the changes, made and read back.
// Who: `settings`; `send`, for the time that a program takes.
//
// Everything is checked against the table before anything is sent. A board may still refuse a value
// that does not go with another one: what it refuses is tried again behind the others, and if it
// refuses for good, what was changed is put back.
#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/dialog.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::link {

/// What a board has told.
struct BoardSettings {
  std::map<std::uint32_t, std::string> texts;  ///< all, by number, as the board writes them
  settings::Values values;                     ///< those of the table; others at their default
  std::bitset<settings::setting_count> known;  ///< rows of the table that the board has told

  bool has(settings::Id id) const { return known.test(static_cast<std::size_t>(id)); }
};

/// Takes a line of `$$`, "$100=200.000"; false if it is none. A value that the table does not allow
/// is kept as text alone.
bool take_setting(std::string_view line, BoardSettings& settings);

/// Asks for all settings. Throws Error: no_device (no answer), job_failed (refused: not at rest).
BoardSettings read_settings(LinePort& port, const Patience& patience = {});

/// A setting and the value that it is to have, as it is sent.
struct Change {
  std::uint32_t number = 0;
  std::string text;
};

/// Row of a setting; Id::count if the table has none with this number.
settings::Id find_setting(std::uint32_t number);
/// The number of a setting given by number, $number or name; nothing if it is no number and no
/// name.
std::optional<std::uint32_t> find_number(std::string_view name);

/// "120 acceleration_x", or the number alone.
std::string setting_name(std::uint32_t number);
/// A value as a board writes it: whole or with three decimals.
std::string value_text(settings::Id id, std::int32_t milli);

/// Reads "NAME=VALUE". Throws Error(bad_input) about `where` if there is no such setting or the
/// table does not allow the value. Numbers that the table does not have are taken as they are.
Change parse_change(std::string_view text, const std::string& where);

/// Those that the board has otherwise. Throws Error(bad_input) for settings that it has not.
std::vector<Change> differing(const BoardSettings& board, const std::vector<Change>& wanted);

/// Makes the changes and reads them back; `before` is what the board has now. Throws Error:
/// no_device, job_failed (refused; the board is as it was).
BoardSettings change_settings(LinePort& port, const BoardSettings& before,
                              const std::vector<Change>& changes);

}  // namespace lamplock::link
