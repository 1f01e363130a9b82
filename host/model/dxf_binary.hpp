// Binary DXF as text DXF (Autodesk, "DXF Reference": binary DXF files, group code value types).
//
// In:  the bytes of a binary DXF. Out: the same groups, each in two lines, with all digits.
// Who: read_dxf().
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock::model {

/// True if the bytes begin with the sentinel of a binary DXF.
bool is_binary_dxf(std::string_view bytes);

/// The groups up to EOF; binary chunks (310, 1004) become empty values. Time and memory grow with
/// the bytes. Throws Error (bad_input) naming the file and the byte: cut off, an unknown group
/// code.
std::string text_of_binary_dxf(const std::filesystem::path& file, std::string_view bytes);

}  // namespace lamplock::model
