// What slicers say about the volumes of a 3MF file in files of their own: which of them are printed
// and which only change settings, are cut out or hold supports. In: the package and its model. Out:
// the model with these volumes left out. Called by read_3mf() once all parts are read.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/model/threemf_model.hpp"
#include "host/model/threemf_package.hpp"

namespace lamplock::model {

struct LeftOutVolumes {
  std::size_t count = 0;
  std::vector<std::string> warnings{};  // the volumes that are left out, a file that is not read
};

/// Reads Metadata/Slic3r_PE_model.config (PrusaSlicer: ranges of triangles of an object) and
/// Metadata/model_settings.config (Bambu Studio, OrcaSlicer: components of an object). A file
/// that is damaged changes nothing.
LeftOutVolumes leave_out_modifiers(const ThreemfPackage& package, ThreemfModel& model);

}  // namespace lamplock::model
