// Writes point lists: XYZ, PLY and DXF. In: points in mm. Out: a file that read_point_list() reads
// back as exactly the same doubles. Called by the command line.
#pragma once

#include <filesystem>
#include <span>

#include "host/geometry/point.hpp"

namespace lamplock::model {

/// One point per line. All throw Error (bad_input) if the file cannot be written.
void write_xyz(const std::filesystem::path& path, std::span<const geometry::Point> cloud);

/// Binary little-endian PLY with double x, y, z.
void write_ply(const std::filesystem::path& path, std::span<const geometry::Point> cloud);

/// One POINT each in the text form of DXF, release 12, which every program reads; unit mm.
void write_dxf(const std::filesystem::path& path, std::span<const geometry::Point> cloud);

}  // namespace lamplock::model
