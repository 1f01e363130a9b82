// Reads scripts for the chip.
//
// In:  text, line by line (docs/chip-script.md has the grammar).
// Out: steps, or one std::runtime_error "WHERE:LINE: WHAT; REMEDY", where the remedy lists what is
//      valid there.
#pragma once

#include <string>
#include <string_view>

#include "sim/chip/script/script.hpp"

namespace lamplock::sim::chip::script {

/// `where` begins the error texts.
Script parse(std::string_view text, const std::string& where);

/// A time such as "2.5s", "10ms", "5us", "100ns", "8000ps", as on a command line; throws
/// std::runtime_error with the same kind of text.
Picoseconds parse_time(std::string_view text, const std::string& where);

}  // namespace lamplock::sim::chip::script
