// The styles of an SVG as attributes (W3C, "Scalable Vector Graphics (SVG) 2", chapter 6; CSS
// cascade).
//
// In:  a document with style sheets, style attributes and presentation attributes. Out: the same
//      document, in which attributes alone have the values that win.
// Who: read_svg(), before it draws.
//
// From the weakest to the strongest: presentation attributes, rules by their specificity and order,
// the style attribute, rules with !important, the style attribute with !important. Only the
// properties that geometry and visibility depend on are set.
#pragma once

#include <cstddef>
#include <pugixml.hpp>
#include <string>
#include <string_view>

namespace lamplock::model {

/// The name of an element, which SvgDocument has freed from its prefix.
std::string_view svg_name(const pugi::xml_node& node);

struct StyleOutcome {
  std::size_t unread_rules = 0;   ///< rules that are not understood
  std::string first_unread_rule;  ///< its selector or its words before the block
  bool too_complex = false;       ///< style sheet and drawing together need too much time
};

/// Recursion is as deep as the document, which the caller limits.
StyleOutcome apply_styles(const pugi::xml_node& root);

}  // namespace lamplock::model
