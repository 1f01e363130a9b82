// Settings of a board in a file: TOML by name, or the lines `$number=value` that senders use.
//
// In:  the settings of a board, or a file. Out: the file, or the settings of a file.
// Who: `settings backup` and `settings restore`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/link/board_settings.hpp"

namespace lamplock::run {

/// True for .toml, in which case the file can be a machine profile, too.
bool is_toml(const std::filesystem::path& file);

/// The text of a backup. TOML has settings that the table does not know as comments only.
std::string backup_text(const link::BoardSettings& board, bool toml);

/// The settings of a file. Throws Error(bad_input) naming the line that is wrong: FILE:LINE.
std::vector<link::Change> read_settings_file(const std::filesystem::path& file);

}  // namespace lamplock::run
