// Records of the material library as TOML: what users exchange, and what lamplock delivers.
//
// In:  a text with tables [[laser]], [[material]], [[setting]], [[measurement]]. Out: the records;
//      text that reads back as the same records.
// Who: import and export of the library, its creation.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host/material/records.hpp"

namespace lamplock::material {

/// Reads records and checks each by itself. Throws Error(bad_input) at FILE:LINE: wrong syntax,
/// unknown tables and fields, values of a wrong kind or out of range, two records with one name, no
/// record at all.
Records parse_records(std::string_view text, const std::filesystem::path& file);
Records read_records(const std::filesystem::path& file);

/// The text of a file with these records.
std::string to_toml(const Records& records);

}  // namespace lamplock::material
