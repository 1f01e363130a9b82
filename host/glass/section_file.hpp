// One section of a description file: parameters by their keys.
//
// In:  a table of TOML, the parameters of the section. Out: their values; lines that read back as
//      the same.
// Who: the readers and writers of descriptions (description_file.hpp,
// host/run/cut_description.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/glass/parameters.hpp"
#include "host/toml_file.hpp"

namespace lamplock::glass {

/// Reads one section: each of its keys at most once, no others. `name` is the section in errors,
/// "[glass]". Throws Error(bad_input) at file and line.
void read_section(const toml::table& table, std::string_view name,
                  const std::vector<Parameter>& known, const std::filesystem::path& file);

/// The lines of the parameters whose values are not the defaults, for a file in `folder`.
std::string section_lines(const std::vector<Parameter>& said,
                          const std::vector<Parameter>& by_default,
                          const std::filesystem::path& folder);

}  // namespace lamplock::glass
