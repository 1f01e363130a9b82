// Reads OBJ files (Wavefront, "Advanced Visualizer Manual", appendix B) in full precision. In: the
// bytes of a file, and its material libraries. Out: its faces as triangles, with brightness from
// colours of vertices, colours (Kd) and pictures (map_Kd) of materials. Called by read_mesh().
#pragma once

#include <filesystem>
#include <string_view>

#include "host/model/mesh_builder.hpp"

namespace lamplock::model {

/// Every `v` must have three finite numbers and every `f` three or more existing corners. Lines,
/// points and curves are ignored. Throws Error (bad_input, naming `file` and the line).
void read_obj(const std::filesystem::path& file, std::string_view bytes, MeshBuilder& mesh);

}  // namespace lamplock::model
