// XML namespaces of 3MF. In: a parsed part with any prefixes. Out: the same part with the prefixes
// that the readers expect, and the check of required extensions. Called by the 3MF reader
// (threemf_package.hpp).
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>

namespace lamplock::model {

/// Renames elements and attributes: no prefix for the core specification, `m` for materials and
/// properties, `p` for production, `b` for beam lattices, `other` for all other namespaces. Throws
/// Error (bad_input, naming `file`) if the part has too many declarations.
void use_own_prefixes(const std::filesystem::path& file, pugi::xml_document& document);

/// Throws Error (bad_input, naming `file` and the extension) if the model requires an extension
/// that is not read.
void check_required_extensions(const std::filesystem::path& file, pugi::xml_node model);

}  // namespace lamplock::model
