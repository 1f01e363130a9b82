// Reads an input file of any kind.
//
// In:  a file. Out: its mesh, picture, points or curves.
// Who: the use cases (placed_model(), order_point_list()); the command line for its help texts.
//
// One table has a row for each extension: what the file holds, and its reader. A new format is a
// row in input.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "host/geometry/point.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/curves.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::model {

enum class InputKind { mesh, bitmap, points, curves };

/// What a file holds; the alternatives are in the order of InputKind.
using Input = std::variant<Mesh, Bitmap, geometry::PointCloud, Curves>;

/// Reads by extension. A .ply is a mesh if its header has faces, otherwise points; a .dxf is points
/// if it has only points, otherwise curves. Throws Error (bad_input) for any other extension, a
/// missing file, and what the reader of the format refuses.
Input read_input(const std::filesystem::path& path);

/// True if files with this extension may be of this kind. Throws Error (bad_input) for an unknown
/// extension or a missing file; does not read the file.
bool may_hold(const std::filesystem::path& path, InputKind kind);

/// The same for a command that reads no other kind: the remedies of its errors name only this one.
bool may_hold_only(const std::filesystem::path& path, InputKind kind);

/// The kind of file that its extension says; empty for unknown extensions. The file need not exist.
std::optional<InputKind> kind_of(const std::filesystem::path& file);

/// Extensions of a kind for texts: "stl, obj, ply, 3mf, glb".
std::string extensions(InputKind kind);

}  // namespace lamplock::model
