// Settings of a board in a file: TOML by name, or the lines `$number=value` that senders use.
//
// In:  what a board keeps; a file. Out: the file; the settings that a file wants.
// Who: `settings backup` and `settings restore`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/link/board_settings.hpp"

namespace lamplock::cli {

/// True for .toml, in which case the file can be a machine profile, too.
bool is_toml(const std::filesystem::path& file);

/// The text of a backup. TOML has settings that the table does not know as comments only.
std::string backup_text(const link::BoardSettings& board, bool toml);

/// What a file wants. Throws Error(bad_input) naming the line that is wrong: FILE:LINE.
std::vector<link::Change> read_settings_file(const std::filesystem::path& file);

}  // namespace lamplock::cli
