// Point lists. Comes in: a file of points in mm. Goes out: the same points in the same order, with
// the exact doubles of the file: they are engraved exactly as given. Called by the command line.
#pragma once

#include <filesystem>

#include "host/points/point.hpp"

namespace lamplock::model {

/// Reads by extension. .ply: no faces. .dxf: POINT entities and nothing else. .cad (a common
/// program of glass engravers): rows `flag layer X Y Z`. Everything else is text: a point a line,
/// three numbers separated by white space, commas or semicolons; more columns (normals, colours)
/// are numbers too and ignored. A first line of names says which columns are x, y and z (or x_mm,
/// ...).
/// `#` begins a comment. Throws Error (bad_input) naming file and line, for a file that is missing,
/// damaged, not finite or without points.
points::PointCloud read_point_list(const std::filesystem::path& path);

}  // namespace lamplock::model
