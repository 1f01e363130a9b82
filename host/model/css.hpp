// Style sheets of CSS as far as drawings have them (W3C, "Cascading Style Sheets Level 2 Revision 1
// (CSS 2.1)", chapters 4 to 6; "Selectors Level 3").
//
// In:  the text of a style sheet, of a style attribute. Out: rules with their selectors and
//      declarations.
// Who: apply_styles() of SVG.
//
// Selectors have elements, *, classes, ids, attributes ([a], [a=b]), :root, and the combinators
// "descendant" and ">". Rules under @media are read if it is for all or for the screen. Rules for
// states of an interaction (:hover) never apply. Others (@supports, @layer, nested ones) are
// counted. A selector that is not valid voids its rule; one that is valid but not understood only
// itself.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::model {

struct CssDeclaration {
  std::string name, value;  ///< the name in lower case, but those of variables (--name)
  bool important = false;
};

/// Conditions for one element.
struct CssCompound {
  struct Attribute {
    std::string name;
    std::optional<std::string> value;
  };
  std::string element;  ///< empty: any
  std::vector<std::string> ids, classes;
  std::vector<Attribute> attributes;
  bool is_root = false;
  bool is_child = false;  ///< of the element of the compound before, not just a descendant
};

struct CssSelector {
  std::vector<CssCompound> compounds;  ///< from the outside
  std::size_t specificity = 0;         ///< greater ones win
  std::size_t declarations = 0;        ///< of StyleSheet
};

struct StyleSheet {
  std::vector<CssSelector> selectors;  ///< in their order in the text
  std::vector<std::vector<CssDeclaration>> declarations;
  std::size_t unread = 0;    ///< selectors and at-rules that are not understood
  std::string first_unread;  ///< its text, for a message

  void leave_out(std::string_view rule);
};

/// The declarations of a style attribute or a rule. Invalid ones are left out, as in CSS.
std::vector<CssDeclaration> css_declarations(std::string_view text);

/// True if a list of media, of @media or of an attribute, has the screen: "screen", "all", "print,
/// screen", "not print", nothing. Conditions in brackets are not known to hold.
bool is_for_screens(std::string_view media);

/// Appends the rules of a text to a style sheet. Time grows with the text.
void read_css(std::string_view text, StyleSheet& sheet);

}  // namespace lamplock::model
