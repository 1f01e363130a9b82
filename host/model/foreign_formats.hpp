// Formats that are not read, and what to export instead. In: an extension. Out: its hint. Called by
// read_input() for the error.
#pragma once

#include <string_view>

namespace lamplock::model {

/// A format that programs for drawings and solids write.
struct ForeignFormat {
  std::string_view extension;  ///< in lower case with its dot
  std::string_view what;       ///< "a DWG drawing"
  std::string_view remedy;
  bool is_model = false;  ///< of solids or meshes
};

/// Null for extensions that are read or unknown.
const ForeignFormat* find_foreign_format(std::string_view extension);

}  // namespace lamplock::model
