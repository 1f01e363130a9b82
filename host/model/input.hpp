// What kind of input a file is, before it is read. Called by the command line to choose reader and
// discretiser.
#pragma once

#include <filesystem>

namespace lamplock::model {

enum class InputKind { mesh, bitmap, points };

/// By extension: .stl .obj mesh; .png .bmp bitmap; .xyz .txt .csv .asc points; .ply is a mesh if
/// its header has faces, points otherwise. Throws Error (bad_input) for any other extension, a
/// missing file or a broken PLY header.
InputKind classify(const std::filesystem::path& path);

}  // namespace lamplock::model
