// What was said about a job and does nothing: a parameter of another method, or one that needs
// another, as the table of parameters has it (description_parameters.cpp).
//
// In:  a description, or one of its objects with the way in which its file becomes points.
// Out: a warning for each such parameter that is not as by default.
// Who: discretise.cpp, prepare.cpp.
#pragma once

#include <string>
#include <vector>

#include "host/glass/description.hpp"

namespace lamplock::glass {

/// Ways from a file to points other than the methods of meshes.
inline constexpr const char* way_of_drawings = "drawings";
inline constexpr const char* way_of_bitmaps = "bitmaps";
inline constexpr const char* way_of_lists = "point lists";

/// The method of meshes that name none.
inline constexpr const char* default_method = "blue-noise";

/// True if objects that become points in this way use the parameter with this key.
bool uses(const std::string& way, const std::string& key);

/// What parameters of an order are for: "order cone".
inline std::string way_of_order(const std::string& order) { return "order " + order; }

/// Warnings about one section, as it was said and as it is by default:
/// "--turn does nothing with blue-noise; it is for slice, rays", "--gamma does nothing without
/// --tone". `way`: what its points, or their order, are made by.
std::vector<std::string> unused(const std::vector<Parameter>& said,
                                const std::vector<Parameter>& by_default, const std::string& way);
/// The same about an object.
std::vector<std::string> unused(const Object& object, const std::string& way);

/// Warnings about all of a description but its objects; `order`: by name, what is chosen.
std::vector<std::string> unused(const Description& description, const std::string& order);

}  // namespace lamplock::glass
