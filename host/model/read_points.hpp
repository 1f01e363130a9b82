// Point lists. Comes in: a file of points in mm. Goes out: the same points in the same order, with
// the exact doubles of the file: they are engraved exactly as given. Called by the command line.
#pragma once

#include <filesystem>
#include <span>

#include "host/points/point.hpp"

namespace lamplock::model {

/// Reads a PLY without faces (.ply) or XYZ text (every other extension): a point a line, three
/// numbers in mm separated by white space or commas; more columns (normals, colours) are numbers
/// too and ignored; `#` begins a comment. Throws Error (bad_input) naming file and line, for a file
/// that is missing, damaged, not finite or without points.
points::PointCloud read_point_list(const std::filesystem::path& path);

/// XYZ text with the shortest digits that read back as exactly the same doubles.
void write_xyz(const std::filesystem::path& path, std::span<const points::Point> cloud);

/// Binary little-endian PLY with double x, y, z.
void write_ply(const std::filesystem::path& path, std::span<const points::Point> cloud);

}  // namespace lamplock::model
