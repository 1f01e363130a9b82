// Soundness of mesh files before the mesh library sees them. Comes in: the bytes of a file. Goes
// out: nothing, or an Error (bad_input) that names `path`. Called by read_mesh() and the PLY
// reader.
#pragma once

#include <filesystem>
#include <string_view>

#include "host/points/point.hpp"

namespace lamplock::model {

/// Every coordinate is a finite number; `index` counts the file's vertices from 0.
void require_finite(const std::filesystem::path& path, std::size_t index,
                    const points::Point& vertex);

/// Binary: as many triangles as the count says; ASCII: every facet and solid closed; all
/// coordinates finite. Gives the length the library may read (programs append bytes to binary STL).
std::size_t check_stl(const std::filesystem::path& path, std::string_view bytes);

/// Every `v` has three finite numbers and every `f` three or more corners that exist.
void check_obj(const std::filesystem::path& path, std::string_view bytes);

}  // namespace lamplock::model
