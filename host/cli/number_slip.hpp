// Numbers that are written as this program does not read them.
//
// In:  the value of an option. Out: the number that is meant. Who: usage_error(), for the remedy.
#pragma once

#include <string>

namespace lamplock::cli {

/// "0.1" for "0,1", which some languages write; empty for other texts.
std::string with_decimal_point(const std::string& text);

/// "0.3" for "0.3mm"; empty for other texts.
std::string without_unit(const std::string& text);

}  // namespace lamplock::cli
