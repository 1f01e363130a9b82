// Reads STL files, binary or ASCII, in full precision. In: the bytes of a file. Out: its triangles,
// with brightness if facets have colours. Called by read_mesh().
#pragma once

#include <filesystem>
#include <string_view>

#include "host/model/mesh_builder.hpp"

namespace lamplock::model {

/// Binary: the count must agree with the triangles (some programs append bytes); ASCII: every facet
/// and solid must be closed. Throws Error (bad_input, naming `file`), also for a coordinate that is
/// not finite.
void read_stl(const std::filesystem::path& file, std::string_view bytes, MeshBuilder& mesh);

}  // namespace lamplock::model
