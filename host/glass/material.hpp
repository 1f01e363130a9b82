// Kinds of glass and their refractive index.
//
// In:  a name or an index. Out: the index. Who: descriptions of jobs.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::glass {

/// A glass. The index is that of the helium d line, 587.6 nm; at the 532 nm of a frequency-doubled
/// Nd:YAG it is greater by about 0.003, which is 0.1 mm in a depth of 50 mm.
struct Material {
  std::string_view name;
  double index;
  std::string_view about;
};

/// The maximum refractive index that is accepted; diamond has 2.4.
inline constexpr double max_index = 4;

/// All materials with a name.
std::span<const Material> materials();
/// Their names.
std::vector<std::string> material_names();
/// The index of a material by its name. Throws Error(bad_input) for an unknown one.
double index_of(const std::string& material);
/// Throws Error(bad_input), at `where`, unless the index is 1..max_index.
void require_index(double index, const std::string& where);

}  // namespace lamplock::glass
