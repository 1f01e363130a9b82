// Reads mesh files. In: STL (binary or ASCII), OBJ, PLY, GLB or 3MF, with the pictures that OBJ and
// GLB name. Out: one triangle mesh in the file's units. Called by the command line. 3MF has a reader
// of its own (read_3mf.hpp). The mesh library (assimp) reads the other formats; because it accepts
// truncated files and invalid numbers, each file is checked first (mesh_checks.hpp, glb.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "host/model/mesh.hpp"

namespace lamplock::model {

/// All meshes of the file joined with their transforms applied, polygons triangulated, equal
/// corners merged, triangles without area by shared corners dropped. Colours of vertices and
/// pictures (base colour) become brightness; a picture that cannot be read is named in
/// unread_pictures and is no error. Coordinates have the library's single precision. Throws Error
/// (bad_input): missing, unreadable or truncated file, a vertex that is not finite (named by its
/// index in the file, from 0), no triangle.
Mesh read_mesh(const std::filesystem::path& path);

/// The same for a file whose bytes were read already.
Mesh decode_mesh(const std::filesystem::path& path, std::string bytes);

}  // namespace lamplock::model
