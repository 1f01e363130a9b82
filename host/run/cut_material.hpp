// Values of cutting operations from the material library.
//
// In:  a description whose operations may name a material, a library. Out: the description with
//      power, feed, passes, air and kerf of the material where its user gave none.
// Who: the use case of cutting.
#pragma once

#include <string>

#include "host/run/cut_description.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

/// Says what each material gives. `library_file` empty: the user's own library. Throws
/// Error(bad_input): a laser or a thickness without a material, what the library lacks.
CutDescription with_materials(CutDescription description, const std::string& library_file,
                              Frontend& frontend);

}  // namespace lamplock::run
