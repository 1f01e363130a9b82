// The example: a nautilus, ribbed outside, with chambers inside, both visible in glass. Out: a
// closed mesh. Called by the command line for demonstration and benchmarks.
//
// Shell and septa are surfaces round a tube that follows a logarithmic spiral (D'Arcy Thompson, "On
// Growth and Form", 1917, chapter XI): all of it grows by the same factor with each turn.
#pragma once

#include <filesystem>

#include "host/model/mesh.hpp"

namespace lamplock::model {

/// Spiral in the x-z plane, closed surfaces with outward normals, longest side 60 mm, centred.
Mesh example_model();

/// Binary STL; coordinates are rounded to its single precision. Throws Error (bad_input) if the
/// file cannot be written.
void write_stl(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace lamplock::model
