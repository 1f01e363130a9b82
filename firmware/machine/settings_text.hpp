// Settings as lines of text, in the form that grbl 1.1 gave them.
//
// In:  "$901=62.5" as the user types it. Out: which setting and its value, or an error number;
//      "$901=62.500" as senders read it.
// Level: main loop; no allocation, no floating point.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/machine/text.hpp"
#include "shared/gcode_errors.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

/// What a line asks for, or why it is refused: unknown_command, bad_number, setting_out_of_range.
struct SettingLine {
  GcodeError error = GcodeError::none;
  settings::Id id = settings::Id::count;
  std::int32_t milli = 0;  ///< thousandths of the unit
};

/// Reads "$number=value": digits, a sign, up to three decimals.
SettingLine read_setting(std::string_view line);

/// Writes "$number=value" and the end of the line.
void write_setting(TextLine& line, settings::Id id, const settings::Values& values);

}  // namespace lamplock::machine
