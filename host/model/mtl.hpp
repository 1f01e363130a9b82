// Materials of an OBJ (Wavefront, "Advanced Visualizer Manual", appendix B), for brightness. In:
// the names of material libraries. Out: colours and pictures by name of material. Called by
// read_obj().
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::model {

struct Material {
  std::optional<float> light{};  // brightness of the diffuse colour (Kd)
  std::string picture{};         // name of the picture (map_Kd) as written; empty if there is none
};

using Materials = std::map<std::string, Material, std::less<>>;

/// Adds the materials of the libraries that a line `mtllib` names: one name with spaces, or several
/// names. Returns the names of those that cannot be opened. Never throws for a damaged one.
std::vector<std::string> read_material_libraries(const std::filesystem::path& obj,
                                                 std::string_view names, Materials& materials);

}  // namespace lamplock::model
