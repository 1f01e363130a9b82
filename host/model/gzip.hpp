// Unpacks gzip (RFC 1952). In: the bytes of a file. Out: the unpacked bytes, limited so that no
// small file fills the memory. Called by the SVG reader for .svgz.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock::model {

/// Maximum bytes after unpacking: a drawing of a million curves has a tenth.
inline constexpr std::size_t max_gunzip_bytes = 128u << 20;

/// True if the bytes begin as gzip does.
bool is_gzip(std::string_view bytes);

/// The unpacked bytes of all members. Throws Error (bad_input, naming `file`) if they are damaged,
/// cut off or more than max_gunzip_bytes.
std::string gunzip(const std::filesystem::path& file, const std::string& bytes);

}  // namespace lamplock::model
