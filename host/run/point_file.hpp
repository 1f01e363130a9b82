// Point lists as results: .xyz, .ply or .dxf, by the extension. Who: `points`, `order`.
#pragma once

#include <filesystem>
#include <span>

#include "host/geometry/point.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) unless a point list can be written there.
void check_point_file(const std::filesystem::path& file);

/// Writes the points, whole or not at all. Throws Error(bad_input).
void write_point_file(const std::filesystem::path& file, std::span<const geometry::Point> cloud);

}  // namespace lamplock::run
