// Makes foreign text safe for a terminal: files, names and boards may contain any bytes, and a
// terminal executes control characters.
//
// In:  any bytes. Out: one line of valid UTF-8 without control characters.
// Who: every error (error.hpp), and all other code that shows foreign text.
#pragma once

#include <string>
#include <string_view>

namespace lamplock {

/// Printable characters stay; a tab or the end of a line becomes a space; controls, characters that
/// change the direction of text and bytes that are not UTF-8 become \xNN or \u{NNNN}.
std::string printable(std::string_view text);

/// Whether all of a text is UTF-8 (RFC 3629). Names of files may be any bytes.
bool is_utf8(std::string_view text);

}  // namespace lamplock
