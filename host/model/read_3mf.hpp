// Reads 3MF files. In: a file. Out: the triangles of all objects that its build places, in mm.
// Called by read_mesh().
//
// Read are: units, components, parts of the production extension, base materials, colour groups,
// composite materials and pictures as brightness. Supports are left out. Beam lattices and
// unknown extensions that a file requires are refused.
#pragma once

#include <filesystem>

#include "host/model/mesh_builder.hpp"

namespace lamplock::model {

/// Throws Error (bad_input, naming `file`, and the object by its id) for a file that is cut off,
/// damaged, hostile, or needs an extension that is not read.
void read_3mf(const std::filesystem::path& file, MeshBuilder& mesh);

}  // namespace lamplock::model
