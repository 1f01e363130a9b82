// Reads mesh files. In: STL (binary or ASCII), OBJ, PLY, GLB or 3MF, with the pictures that they
// name. Out: one triangle mesh. Called by read_input(). Each format has a reader (read_stl.hpp,
// read_obj.hpp, ply.hpp, read_glb.hpp, read_3mf.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "host/model/mesh.hpp"

namespace lamplock::model {

/// All meshes of the file joined with their transforms applied, polygons triangulated, equal
/// corners merged, triangles without area by shared corners dropped. Colours and pictures become
/// brightness; a picture that cannot be read is named in unread_pictures and is no error. GLB and
/// 3MF are in mm with z up, the other formats as the file has them. Coordinates have the precision
/// of the file. Throws Error (bad_input): missing, unreadable or truncated file, a vertex that is
/// not finite (named by its index in the file, from 0), no triangle.
Mesh read_mesh(const std::filesystem::path& path);

/// The same for a file whose bytes were read already; a 3MF is opened again.
Mesh decode_mesh(const std::filesystem::path& path, const std::string& bytes);

}  // namespace lamplock::model
