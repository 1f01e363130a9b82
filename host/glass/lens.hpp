// The lens, which limits the spacing of defects.
//
// In:  a name. Out: recommended distance of points, which becomes the default of the spacing.
// Who: descriptions of jobs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::glass {

/// A focusing lens.
struct Lens {
  std::string_view name;
  double spacing_mm;  ///< points closer than this merge
};

/// Names of all lenses.
std::vector<std::string> lens_names();
/// A lens by its name. Throws Error(bad_input) for an unknown one.
const Lens& lens_named(const std::string& name);

}  // namespace lamplock::glass
