// Reads TOML files, with errors at file and line. Called by the readers of profiles and of
// descriptions.
#pragma once

// toml++ as a library with exceptions; every file that includes it must define the same.
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <filesystem>
#include <string>

namespace lamplock {

/// "FILE:LINE", for errors: refuse() of host/file.hpp.
std::string toml_location(const std::filesystem::path& file, const toml::source_region& source);

/// Throws Error(bad_input) that says in plain words what is wrong in the line.
[[noreturn]] void refuse_toml(const std::filesystem::path& file, const toml::parse_error& error);

/// Throws Error(bad_input): a file that cannot be read, or invalid TOML, with its line.
toml::table read_toml(const std::filesystem::path& file);

}  // namespace lamplock
