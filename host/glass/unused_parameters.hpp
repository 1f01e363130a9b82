// Finds parameters without effect on a job: those of another method, or those that need another
// parameter, by the table of parameters (description_parameters.cpp).
//
// In:  a description, or one of its objects with its method or kind of file.
// Out: a warning for each such parameter that does not have its default.
// Who: discretise.cpp, prepare.cpp.
#pragma once

#include <string>
#include <vector>

#include "host/glass/description.hpp"

namespace lamplock::glass {

/// Kinds of files other than meshes.
inline constexpr const char* way_of_drawings = "drawings";
inline constexpr const char* way_of_bitmaps = "bitmaps";
inline constexpr const char* way_of_lists = "point lists";

/// The default method of meshes.
inline constexpr const char* default_method = "blue-noise";

/// True if objects of this method or kind of file use the parameter with this key.
bool uses(const std::string& way, const std::string& key);

/// The name of an order in `used_by`: "order cone".
inline std::string way_of_order(const std::string& order) { return "order " + order; }

/// Warnings about one section, compared with its defaults:
/// "--turn does nothing with blue-noise; it is for slice, rays", "--gamma does nothing without
/// --tone". `way`: its method, kind of file, or order.
std::vector<std::string> unused(const std::vector<Parameter>& said,
                                const std::vector<Parameter>& by_default, const std::string& way);
/// The same for an object.
std::vector<std::string> unused(const Object& object, const std::string& way);

/// Warnings about all of a description but its objects; `order`: the name of the chosen order.
std::vector<std::string> unused(const Description& description, const std::string& order);

}  // namespace lamplock::glass
