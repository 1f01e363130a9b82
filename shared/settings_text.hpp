// Settings as lines of text, in the format of grbl 1.1.
//
// In:  "$901=62.5" as the user types it. Out: the setting and its value, or an error number;
//      "$901=62.500" as senders read it.
// Level: main loop; no allocation, no floating point.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/gcode_errors.hpp"
#include "shared/settings_table.hpp"
#include "shared/text_line.hpp"

namespace lamplock::settings {

/// A setting to be changed, or the reason of a refusal: unknown_command, bad_number,
/// setting_out_of_range.
struct SettingLine {
  GcodeError error = GcodeError::none;
  Id id = Id::count;
  std::uint16_t number = 0;  ///< 0 if the text has none
  std::int32_t milli = 0;    ///< thousandths of the unit
};

/// Reads "$number=value": digits, a sign, up to three decimals.
SettingLine read_setting(std::string_view line);

/// Writes "$number=value" and the end of the line.
void write_setting(TextLine& line, Id id, const Values& values);

}  // namespace lamplock::settings
