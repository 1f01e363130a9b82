// Pictures of the materials of an OBJ (Wavefront, "Advanced Visualizer Manual", appendix B), for
// brightness. In: the text of an OBJ. Out: pictures by name of material. Called by read_mesh(); the
// mesh library is not used for materials, because damaged ones make it crash.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace lamplock::model {

/// The picture (map_Kd) of each material in the libraries that the OBJ names, as written there.
/// A library that is missing has no materials. Never throws for a damaged one.
std::map<std::string, std::string> pictures_of_materials(const std::filesystem::path& path,
                                                         const std::string& obj);

/// The text with its `mtllib` lines made comments.
std::string without_material_libraries(std::string obj);

}  // namespace lamplock::model
