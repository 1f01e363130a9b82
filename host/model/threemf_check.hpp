// 3MF files ("3D Manufacturing Format, Core Specification", 3MF Consortium, version 1.2; colours
// and pictures: "Materials and Properties Extension"), as far as the check of a file needs it. In:
// a file. Out: an Error for a bad file. Called by read_mesh() before the mesh library, which does
// not check ids, indices and counts.
//
// Checked: the container (zip_archive.hpp), that its parts are XML of bounded size, that ids are
// unique, that meshes have finite vertices and triangles of them, that colours and transformations
// exist, how objects are nested (threemf_objects.hpp), and that at least one object is built.
#pragma once

#include <filesystem>

namespace lamplock::model {

/// Throws Error (bad_input, naming `file`, and the object by its id) for a file that is cut off,
/// damaged, hostile, or has its objects in other parts ("Production Extension").
void check_3mf(const std::filesystem::path& file);

}  // namespace lamplock::model
