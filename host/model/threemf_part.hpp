// One model part of a 3MF file ("3D Manufacturing Format, Core Specification", 3MF Consortium,
// version 1.3; parts: "Production Extension", version 1.1). In: its XML. Out: its objects, and of
// the first part the build, in a ThreemfModel. Called by read_3mf().
#pragma once

#include <filesystem>
#include <pugixml.hpp>

#include "host/model/threemf_model.hpp"

namespace lamplock::model {

/// Adds what part `number` of `model.parts` contains; parts that it names are appended to
/// `model.parts`. Throws Error (bad_input, naming `file` and the object by its id): ids, indices or
/// numbers that are missing, invalid or do not exist, a beam lattice.
void read_threemf_part(const std::filesystem::path& file, int number, pugi::xml_node part,
                       ThreemfModel& model);

}  // namespace lamplock::model
