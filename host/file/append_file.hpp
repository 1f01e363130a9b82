// Lines appended to a file that other programs may append to as well: whole or not at all.
//
// In:  a file and a text. Out: the text at the end of the file, or an Error and the file as it was.
// Who: the statistics of a workshop.
#pragma once

#include <filesystem>
#include <string_view>

namespace lamplock {

/// Proves that a text can be appended. If the file exists, space for a line is reserved after its
/// end, otherwise as check_target(). Throws Error(bad_input).
void check_appendable(const std::filesystem::path& file);

/// Appends a text by one write, and makes the file if necessary. A text of which the disk has taken
/// a part only is removed again. Throws Error(bad_input).
void append_whole(const std::filesystem::path& file, std::string_view text);

}  // namespace lamplock
