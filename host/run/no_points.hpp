// Why an object gives no points, and what gives some.
//
// In:  a placed model, its object description, the spacing. Out: an Error.
// Who: discretise.cpp, after the method has returned no points.
#pragma once

#include "host/glass/description.hpp"
#include "host/run/placed_model.hpp"

namespace lamplock::run {

/// Throws Error (bad_input) that names the file, the cause (planes, direction, grey values) and a
/// remedy.
[[noreturn]] void refuse_without_points(const PlacedModel& model, const glass::Object& object,
                                        double spacing_mm);

/// The same for points that only the densities of depth have removed.
[[noreturn]] void refuse_thinned_out(const glass::Object& object);

}  // namespace lamplock::run
