// Reads the actions of keys of pendants and the keyboard: the table [pendant] of a machine profile.
//
// In:  a TOML file (docs/pendants.md, examples/pendant.toml). Out: a KeyMap; keys that the file
//      does not state are those of default_key_map().
// Who: `lamplock jog`.
#pragma once

#include <filesystem>

#include "host/pendant/key_map.hpp"

namespace lamplock::pendant {

/// Reads the table [pendant]; a file without it gives the defaults. Throws Error(bad_input) with
/// file, line, key.
KeyMap read_key_map(const std::filesystem::path& file);

}  // namespace lamplock::pendant
