// Reads what the keys of pendants and of the keyboard do: the table [pendant] of a machine profile.
//
// In:  a TOML file (docs/pendants.md, examples/pendant.toml). Out: a KeyMap; what the file does not
//      state is as default_key_map() says.
// Who: `lamplock jog`.
#pragma once

#include <filesystem>

#include "host/pendant/key_map.hpp"

namespace lamplock::pendant {

/// Reads the table [pendant]; a file without it gives the defaults. Throws Error(bad_input) with
/// file, line, key.
KeyMap read_key_map(const std::filesystem::path& file);

}  // namespace lamplock::pendant
