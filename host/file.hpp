// Reads and writes whole files, with errors for the user. Called by all readers and writers.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock {

/// Throws Error (bad_input) about `path`.
[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what,
                         const std::string& remedy);

/// Throws Error (bad_input) if the file does not exist or is a folder or a device.
void check_is_file(const std::filesystem::path& path);

/// All bytes of a file. Throws Error (bad_input) if it is missing, no file, unreadable or empty.
std::string read_file(const std::filesystem::path& path);

/// Throws Error (bad_input) for UTF-16, with its mark or ASCII in it.
void refuse_utf16(const std::filesystem::path& path, std::string_view text);

/// read_file() of a text; refuses UTF-16 too.
std::string read_text_file(const std::filesystem::path& path);

/// Replaces the file. Throws Error (bad_input) if it cannot be written.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The extension in lower case with its dot, `.stl`.
std::string lower_extension(const std::filesystem::path& path);

}  // namespace lamplock
