// Reads the roles of the computer's lines: the file that `--lines` names, or [lines] of a machine
// profile.
//
// In:  a TOML file (examples/lines.toml). Out: a LineTable.
// Who: the command line.
#pragma once

#include <filesystem>
#include <string_view>

#include "host/gpio/line_table.hpp"

namespace lamplock::gpio {

/// Parses the text of such a file; `file` names it in errors. Throws Error(bad_input) with file,
/// line, key and allowed values; also if two roles have the same line.
LineTable parse_line_table(std::string_view text, const std::filesystem::path& file);

/// Reads a file. Throws as parse_line_table().
LineTable read_line_table(const std::filesystem::path& file);

/// Reads [lines.estop] and so on from a machine profile; empty if it has none. Throws as
/// parse_line_table().
LineTable read_machine_lines(const std::filesystem::path& profile);

}  // namespace lamplock::gpio
