// Descriptions of jobs as files.
//
// In:  a TOML file. Out: a Description; text that reads back as the same.
// Who: the command line.
#pragma once

#include <filesystem>
#include <string>

#include "host/glass/description.hpp"

namespace lamplock::glass {

/// By extension: .toml.
bool is_description(const std::filesystem::path& file);

/// Reads a description; names of files in it are relative to its folder. Throws Error(bad_input) at
/// file and line: syntax, unknown sections and keys, wrong kinds of values, values out of range, no
/// object, an object without a file.
Description read_description(const std::filesystem::path& file);

/// The text of a description for a file in `folder`, without default values.
std::string to_text(const Description& description, const std::filesystem::path& folder);

}  // namespace lamplock::glass
