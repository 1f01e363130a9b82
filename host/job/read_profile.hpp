// Reads a machine profile.
//
// In:  a TOML file (examples/machine.toml). Out: a Profile.
// Who: the command line.
#pragma once

#include <filesystem>

#include "host/job/profile.hpp"

namespace lamplock::job {

/// Reads a profile; what it does not state stays at its default. Keys: `name`, the names of the
/// settings table, their former names (host/former_names.hpp), and arrays over the axes without the
/// axis suffix (`travel = [100, 100, 60]`).
/// The tables `pendant` and `lines` are skipped: host/pendant/read_key_map.hpp and
/// host/gpio/read_line_table.hpp read them. Throws Error(bad_input) with file, line, key and range.
Profile read_profile(const std::filesystem::path& file);

}  // namespace lamplock::job
