// Checks the nesting of objects in a 3MF file. In: objects by their ids, each with the ids of those
// inside. Out: an Error that names an object that contains itself, is nested too deeply or is
// copied too often. Called by the check of 3MF files (threemf_check.hpp), because the mesh library
// follows the ids by recursion and makes all copies.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace lamplock::model {

/// An object: a mesh, or others inside it.
struct ThreemfObject {
  std::uint64_t triangles = 0;
  std::vector<int> inside{};
};
using ThreemfObjects = std::map<int, ThreemfObject>;

/// `items`: ids of the objects that are built. Throws Error (bad_input, naming `file`): an unknown
/// id, an object inside itself, nesting deeper than 100, more than 100 000 placed objects or 20
/// million placed triangles. Time linear.
void check_placed(const std::filesystem::path& file, const ThreemfObjects& objects,
                  const std::vector<int>& items);

}  // namespace lamplock::model
