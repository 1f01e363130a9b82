// The records that lamplock delivers, of data/materials.toml.
//
// Out: the text of that file, which a step of the build puts into the program (embed.cmake).
// Who: the library when it makes a new file.
#pragma once

#include <string_view>

namespace lamplock::material {

std::string_view delivered_text();

}  // namespace lamplock::material
