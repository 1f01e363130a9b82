// Reads TOML files, with errors at file and line. Called by the readers of profiles and of
// descriptions.
#pragma once

// toml++ as a library with exceptions; every file that includes it must define the same.
// Some damaged files ("[+]", "a = [}") reach assertions of its parser (version 3.3). Without NDEBUG
// they would end the program, with it the compiler would assume that they hold; here they throw in
// every build.
#include <stdexcept>

namespace lamplock {

/// An assertion of toml++ does not hold: the file is damaged in a way that its parser does not
/// refuse.
class TomlAssertion : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void toml_assertion_failed(const char* condition) {
  throw TomlAssertion(condition);
}

}  // namespace lamplock

#define TOML_EXCEPTIONS 1
#define TOML_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : lamplock::toml_assertion_failed(#condition))
#pragma push_macro("NDEBUG")
#undef NDEBUG
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock {

/// "FILE:LINE", for errors: refuse() of host/file.hpp.
std::string toml_location(const std::filesystem::path& file, const toml::source_region& source);

/// The table in a text; `file` is its name in errors. Throws Error(bad_input) that says in plain
/// words what is wrong in which line.
toml::table parse_toml(std::string_view text, const std::filesystem::path& file);

/// Throws Error(bad_input): a file that cannot be read, or invalid TOML, with its line.
toml::table read_toml(const std::filesystem::path& file);

}  // namespace lamplock
