// 3MF files ("3D Manufacturing Format, Core Specification", 3MF Consortium, version 1.2; colours
// and pictures: "Materials and Properties Extension"), as far as the soundness of a file needs it.
// Comes in: a file. Goes out: nothing, or an Error. Called by read_mesh() before the mesh library,
// which believes every id, index and count.
//
// Checked: the container (zip_archive.hpp), that its parts are XML of bounded size, that ids are
// there once, that meshes have finite vertices and triangles of them, that colours and
// transformations are there, how objects stand in objects (threemf_objects.hpp), and that something
// is built.
#pragma once

#include <filesystem>

namespace lamplock::model {

/// Throws Error (bad_input, naming `file`, and the object by its id) for a file that is cut off,
/// damaged, hostile, or keeps its objects in other parts ("Production Extension").
void check_3mf(const std::filesystem::path& file);

}  // namespace lamplock::model
