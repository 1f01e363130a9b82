// Entities that an XML file declares itself (W3C, "Extensible Markup Language (XML) 1.0", chapter
// 4): drawing programs put styles and the names of namespaces into them.
//
// In:  the text of a file in UTF-8. Out: the same text with the replacement texts for the
//      references, on the same lines.
// Who: SvgDocument.
//
// Character references and the five predefined entities are left to the parser of XML. Parameter
// entities of the internal subset are read, too. Files of others are never opened.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace lamplock::model {

struct ExpandedXml {
  std::string text;
  std::size_t external = 0;    ///< references to entities of other files, left out
  std::size_t undeclared = 0;  ///< references to entities without a declaration, left as they are
};

/// Throws Error (bad_input) that names the file, the line and the entity: one that refers to
/// itself, more levels or more text than drawings have.
ExpandedXml expand_entities(const std::filesystem::path& file, std::string text);

}  // namespace lamplock::model
