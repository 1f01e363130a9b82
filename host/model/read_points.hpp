// Point lists. In: a file of points in mm. Out: the same points in the same order, with the exact
// doubles of the file: they are engraved exactly as given. Called by the command line.
#pragma once

#include <filesystem>
#include <string>

#include "host/geometry/point.hpp"
#include "host/model/curves.hpp"

namespace lamplock::model {

/// Reads by extension. .ply: no faces. .dxf: POINT entities only. .cad (a common program of glass
/// engravers): rows `flag layer X Y Z`. All other files are text: one point per line, three numbers
/// separated by white space, commas or semicolons. A first line of names selects the columns x, y
/// and z (or x_mm, ...); only with it there may be more columns (normals, colours), which are
/// ignored.
/// `#` begins a comment. Throws Error (bad_input) naming file and line, for a file that is missing,
/// damaged, not finite or without points, for decimal commas, and for more columns than names.
geometry::PointCloud read_point_list(const std::filesystem::path& path);

/// The same for a file whose bytes were read already; not for .dxf.
geometry::PointCloud decode_point_list(const std::filesystem::path& path, const std::string& bytes);

/// The points of a .dxf that has nothing else. Throws Error (bad_input) naming the file.
geometry::PointCloud points_of_drawing(const std::filesystem::path& path, Curves drawing);

}  // namespace lamplock::model
