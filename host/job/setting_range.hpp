// The allowed values of a setting, in words.
//
// In:  a row of the table of settings. Out: the remedy of an error. Who: readers of profiles and of
//      changes.
#pragma once

#include <string>

#include "shared/settings_table.hpp"

namespace lamplock::job {

/// "give 0.1 to 1000 Hz", "give 0 to 15, a whole number", "give 0 (off) or 1 (on)".
std::string setting_range(const settings::Row& row);

/// What follows a value in a text, with a space before it: " mm". Empty for choices and numbers,
/// where the unit of the table is the range: "0..15".
std::string unit_suffix(const settings::Row& row);

}  // namespace lamplock::job
