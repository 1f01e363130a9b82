// Checks the nesting of objects in a 3MF file. In: the objects and the build. Out: an Error that
// names an object that contains itself, is nested too deeply or is copied too often. Called by
// read_3mf() before it copies the objects.
#pragma once

#include <filesystem>

#include "host/model/threemf_model.hpp"

namespace lamplock::model {

/// Throws Error (bad_input, naming `file`): an unknown id, an object inside itself, nesting deeper
/// than 100, more than 100 000 placed objects or 8 million placed triangles. Time linear.
void check_placed(const std::filesystem::path& file, const ThreemfModel& model);

}  // namespace lamplock::model
