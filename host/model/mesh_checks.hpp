// Checks mesh files before the mesh library reads them. In: the bytes of a file. Out: an Error
// (bad_input) that names `path` for a bad file. Called by read_mesh() and the PLY reader.
#pragma once

#include <filesystem>
#include <string_view>

#include "host/geometry/point.hpp"

namespace lamplock::model {

/// Every coordinate must be a finite number; `index` counts the file's vertices from 0.
void require_finite(const std::filesystem::path& path, std::size_t index,
                    const geometry::Point& vertex);

/// Binary: the count must agree with the triangles; ASCII: every facet and solid must be closed;
/// all coordinates must be finite. Returns the length that the library may read (some programs
/// append bytes to binary STL).
std::size_t check_stl(const std::filesystem::path& path, std::string_view bytes);

/// Every `v` must have three finite numbers and every `f` three or more existing corners.
void check_obj(const std::filesystem::path& path, std::string_view bytes);

}  // namespace lamplock::model
