// Namespaces of an SVG document (W3C, "Namespaces in XML 1.0"; "Scalable Vector Graphics (SVG) 2",
// chapter 5: elements of another namespace are not drawn).
//
// In:  a parsed document. Out: the same document with elements of SVG alone, without prefixes, and
//      with the usual prefixes of the attributes that the reader knows.
// Who: SvgDocument, before it reads styles and ids.
#pragma once

#include <cstddef>
#include <pugixml.hpp>
#include <string>

namespace lamplock::model {

struct NamespaceOutcome {
  bool is_svg = true;    ///< the root is the element svg of SVG, or of no namespace
  std::string root_uri;  ///< the namespace of the root
  /// Elements of other namespaces that look like parts of the drawing: without a prefix, or with
  /// the name of a shape or a group. Those of editors are not counted.
  std::size_t foreign = 0;
};

/// Removes the elements of other namespaces with all that is in them. A document without namespaces
/// is one of SVG, as the prefix svg without a declaration is. Elements deeper than `max_depth` are
/// not changed: the caller refuses them. If the root is not svg, nothing is changed.
NamespaceOutcome keep_svg_elements(pugi::xml_node root, int max_depth);

}  // namespace lamplock::model
