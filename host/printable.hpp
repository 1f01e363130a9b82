// Text of others made fit for a terminal: what files, names and boards contain may be anything, and
// a terminal obeys control characters.
//
// In:  any bytes. Out: one line of valid UTF-8 without control characters.
// Who: every error (error.hpp), and who else shows text of others.
#pragma once

#include <string>
#include <string_view>

namespace lamplock {

/// Printable characters stay; a tab or the end of a line becomes a space; controls, characters that
/// change the direction of text and bytes that are not UTF-8 become \xNN or \u{NNNN}.
std::string printable(std::string_view text);

}  // namespace lamplock
