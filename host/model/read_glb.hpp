// Reads GLB files ("glTF 2.0 Specification", Khronos): metres with y up become mm with z up. In:
// the bytes of a file. Out: the triangles of its scene, with brightness from colours of vertices,
// base colours and pictures. Called by read_mesh().
#pragma once

#include <filesystem>
#include <string_view>

#include "host/model/mesh_builder.hpp"

namespace lamplock::model {

/// Throws Error (bad_input, naming `file`) for a file that is cut off, damaged or requires an
/// extension that is not read, and for copies of meshes that fill the memory.
void read_glb(const std::filesystem::path& file, std::string_view bytes, MeshBuilder& mesh);

}  // namespace lamplock::model
