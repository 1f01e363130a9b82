// Reads which lines of the computer do what: the file that `--lines` names, or [lines] of a machine
// profile.
//
// In:  a TOML file (examples/lines.toml). Out: a LineTable.
// Who: the command line.
#pragma once

#include <filesystem>
#include <string_view>

#include "host/gpio/line_table.hpp"

namespace lamplock::gpio {

/// Takes the text of such a file apart; `file` names it in errors. Throws Error(bad_input) with
/// file, line, key and what it may be; two roles on one line, too.
LineTable parse_line_table(std::string_view text, const std::filesystem::path& file);

/// Reads a file. Throws as parse_line_table().
LineTable read_line_table(const std::filesystem::path& file);

/// What a machine profile says under `lines`: [lines.estop] and so on; no lines if it says nothing.
/// Throws as parse_line_table().
LineTable read_machine_lines(const std::filesystem::path& profile);

}  // namespace lamplock::gpio
