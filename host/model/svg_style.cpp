#include "host/model/svg_style.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/letter_case.hpp"
#include "host/model/css.hpp"
#include "host/model/css_variables.hpp"
#include "host/model/svg_paint.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

struct Property {
  std::string_view name;
  bool inherited;
  std::string_view initial;
};
constexpr std::array<Property, 48> properties{{{"display", false, "inline"},
                                               {"visibility", true, "visible"},
                                               {"opacity", false, "1"},
                                               {"color", true, "black"},
                                               {"fill", true, "black"},
                                               {"fill-opacity", true, "1"},
                                               {"stroke", true, "none"},
                                               {"stroke-opacity", true, "1"},
                                               {"stroke-width", true, "1"},
                                               {"stroke-dasharray", true, "none"},
                                               {"stroke-dashoffset", true, "0"},
                                               {"stroke-linecap", true, "butt"},
                                               {"clip-path", false, "none"},
                                               {"clip-rule", true, "nonzero"},
                                               {"fill-rule", true, "nonzero"},
                                               {"filter", false, "none"},
                                               {"mask", false, "none"},
                                               {"mask-type", false, "luminance"},
                                               {"vector-effect", false, "none"},
                                               {"marker", true, "none"},
                                               {"marker-start", true, "none"},
                                               {"marker-mid", true, "none"},
                                               {"marker-end", true, "none"},
                                               {"overflow", false, ""},
                                               {"transform", false, ""},
                                               {"transform-origin", false, ""},
                                               {"transform-box", false, "view-box"},
                                               {"translate", false, ""},
                                               {"rotate", false, ""},
                                               {"scale", false, ""},
                                               {"font-size", true, "medium"},
                                               {"letter-spacing", true, "normal"},
                                               {"word-spacing", true, "normal"},
                                               {"text-transform", true, "none"},
                                               {"text-decoration", false, "none"},
                                               {"writing-mode", true, "horizontal-tb"},
                                               {"text-anchor", true, "start"},
                                               {"dominant-baseline", true, "auto"},
                                               {"x", false, "0"},
                                               {"y", false, "0"},
                                               {"width", false, ""},
                                               {"height", false, ""},
                                               {"cx", false, "0"},
                                               {"cy", false, "0"},
                                               {"r", false, "0"},
                                               {"rx", false, ""},
                                               {"ry", false, ""},
                                               {"d", false, ""}}};

const Property* property_named(std::string_view name) {
  const auto* const found = std::find_if(properties.begin(), properties.end(),
                                         [&](const Property& p) { return p.name == name; });
  return found == properties.end() ? nullptr : found;
}

/// Paths and functions of transformations have letters whose case matters.
bool is_case_sensitive(std::string_view property) {
  return property == "d" || property == "transform";
}

/// Keywords, units and names of functions in lower case; addresses in url() as they are.
std::string with_lower_keywords(std::string_view value) {
  constexpr std::string_view address = "url(";
  std::string lower = in_lower_case(value);
  for (std::size_t at = lower.find(address); at != std::string::npos;) {
    const std::size_t from = at + address.size();
    const std::size_t end = std::min(value.find(')', from), value.size());
    lower.replace(from, end - from, value.substr(from, end - from));
    at = lower.find(address, end);
  }
  return lower;
}

/// The size in "bold 20px/1.2 serif" (CSS Fonts Module Level 4, section 2.7): the first keyword of
/// sizes or number with a unit, which a weight has not. A keyword for all properties is that of the
/// size, too.
std::string_view size_of_font(std::string_view font) {
  constexpr std::array<std::string_view, 9> sizes{"xx-small", "x-small", "small",
                                                  "medium",   "large",   "x-large",
                                                  "xx-large", "smaller", "larger"};
  for (std::string_view rest = font; !rest.empty();) {
    const std::string_view word =
        rest.substr(0, std::min(rest.find_first_of(" \t\r\n/"), rest.size()));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    const bool is_number = word.find_first_of("0123456789.") == 0;
    const bool has_unit =
        !word.empty() && (word.back() == '%' || (word.back() >= 'a' && word.back() <= 'z'));
    if ((is_number && has_unit) || std::find(sizes.begin(), sizes.end(), word) != sizes.end())
      return word;
  }
  return font;
}

/// Characters of variables that take as long as a comparison of a rule with an element.
constexpr std::size_t characters_a_step = 4;

bool has_class(const xml_node& node, std::string_view name) {
  std::string_view classes = node.attribute("class").value();
  constexpr std::string_view blanks = " \t\r\n\f";
  while (true) {
    const std::size_t begin = classes.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return false;
    classes.remove_prefix(begin);
    const std::string_view one = classes.substr(0, classes.find_first_of(blanks));
    if (one == name) return true;
    classes.remove_prefix(one.size());
  }
}

bool fits(const CssCompound& compound, const xml_node& node) {
  if (!compound.element.empty() && compound.element != svg_name(node)) return false;
  if (compound.is_root && node.parent().type() != pugi::node_document) return false;
  for (const std::string& id : compound.ids) {
    if (node.attribute("id").value() != id) return false;
  }
  for (const std::string& name : compound.classes) {
    if (!has_class(node, name)) return false;
  }
  for (const auto& [name, value] : compound.attributes) {
    const pugi::xml_attribute attribute = node.attribute(name.c_str());
    if (!attribute || (value && attribute.value() != *value)) return false;
  }
  return true;
}

class Cascade {
 public:
  StyleOutcome apply(const xml_node& root) {
    read_sheets(root);
    for (std::size_t i = 0; i < sheet_.selectors.size(); ++i) {
      const CssCompound& last = sheet_.selectors[i].compounds.back();
      if (!last.ids.empty())
        by_id_[last.ids.front()].push_back(i);
      else if (!last.classes.empty())
        by_class_[last.classes.front()].push_back(i);
      else
        by_element_[last.element].push_back(i);
    }
    apply_below(root, {});
    outcome_.unread_rules = sheet_.unread;
    outcome_.first_unread_rule = sheet_.first_unread;
    return outcome_;
  }

 private:
  using Index = std::unordered_map<std::string, std::vector<std::size_t>>;

  void read_sheets(const xml_node& node) {
    if (svg_name(node) == "style") {
      const std::string_view type = node.attribute("type").value();
      if (!type.empty() && type != "text/css") return;
      const std::string_view media = node.attribute("media").value();
      if (!is_for_screens(media)) {
        sheet_.leave_out(fmt::format("@media {}", media));
        return;
      }
      std::string text;
      for (const xml_node& child : node.children()) text += child.value();
      read_css(text, sheet_);
    }
    for (const xml_node& child : node.children()) read_sheets(child);
  }

  void apply_below(const xml_node& node, const CssVariables& above) {
    if (outcome_.too_complex) return;
    std::optional<CssVariables> own;
    if (node.type() == pugi::node_element) own = apply_to(node, above);
    for (const xml_node& child : node.children()) apply_below(child, own ? *own : above);
  }

  /// Counts work, which may grow with the product of rules and elements.
  bool spend(std::size_t count) {
    constexpr std::size_t max_work = 20'000'000;
    work_ += count;
    outcome_.too_complex = outcome_.too_complex || work_ > max_work;
    return !outcome_.too_complex;
  }

  /// The ancestors of a descendant are searched from the inside; the first that fits may be the
  /// wrong one for a later ">", so all are tried.
  bool matches(const std::vector<CssCompound>& compounds, std::size_t count, const xml_node& node) {
    if (!spend(1) || !fits(compounds[count - 1], node)) return false;
    if (count == 1) return true;
    xml_node above = node.parent();
    for (; above.type() == pugi::node_element && !outcome_.too_complex; above = above.parent()) {
      if (matches(compounds, count - 1, above)) return true;
      if (compounds[count - 1].is_child) return false;
    }
    return false;
  }

  void collect(const Index& index, const std::string& name, const xml_node& node,
               std::vector<std::size_t>& found) {
    const auto entry = index.find(name);
    if (entry == index.end()) return;
    for (const std::size_t selector : entry->second) {
      const std::vector<CssCompound>& compounds = sheet_.selectors[selector].compounds;
      if (matches(compounds, compounds.size(), node)) found.push_back(selector);
    }
  }

  std::vector<std::size_t> selectors_of(const xml_node& node) {
    std::vector<std::size_t> found;
    if (sheet_.selectors.empty()) return found;
    collect(by_id_, node.attribute("id").value(), node, found);
    std::string_view classes = node.attribute("class").value();
    while (!classes.empty()) {
      const std::size_t begin = classes.find_first_not_of(" \t\r\n\f");
      if (begin == std::string_view::npos) break;
      classes.remove_prefix(begin);
      const std::string_view one = classes.substr(0, classes.find_first_of(" \t\r\n\f"));
      collect(by_class_, std::string(one), node, found);
      classes.remove_prefix(one.size());
    }
    collect(by_element_, std::string(svg_name(node)), node, found);
    collect(by_element_, "", node, found);
    std::sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(sheet_.selectors[a].specificity, a) <
             std::pair(sheet_.selectors[b].specificity, b);
    });
    return found;
  }

  /// Those of rules and `own` ones, of the style attribute, from the weakest to the strongest.
  std::vector<const CssDeclaration*> in_order(const xml_node& node,
                                              const std::vector<CssDeclaration>& own) {
    const std::vector<std::size_t> selectors = selectors_of(node);
    std::vector<const CssDeclaration*> all;
    const auto add = [&](const std::vector<CssDeclaration>& declarations, bool important) {
      if (!spend(declarations.size())) return;
      for (const CssDeclaration& one : declarations)
        if (one.important == important) all.push_back(&one);
    };
    for (const bool important : {false, true}) {
      for (const std::size_t selector : selectors)
        add(sheet_.declarations[sheet_.selectors[selector].declarations], important);
      add(own, important);
    }
    return all;
  }

  /// Those of the element, if it sets any; otherwise it has those of its parent.
  std::optional<CssVariables> variables_of(const std::vector<const CssDeclaration*>& declarations,
                                           const CssVariables& above) {
    std::optional<CssVariables> own;
    for (const CssDeclaration* one : declarations) {
      if (!one->name.starts_with("--")) continue;
      if (!own && spend(above.size())) own = above;
      if (own) own->insert_or_assign(one->name, one->value);
    }
    return own;
  }

  /// Returns the variables of the element, if it sets any.
  std::optional<CssVariables> apply_to(xml_node node, const CssVariables& above) {
    const std::vector<CssDeclaration> of_attribute =
        css_declarations(node.attribute("style").value());
    const std::vector<const CssDeclaration*> declarations = in_order(node, of_attribute);
    std::optional<CssVariables> own = variables_of(declarations, above);
    const CssVariables& variables = own ? *own : above;
    // Attributes with these names belong to text and filters.
    for (const char* name : {"translate", "rotate", "scale"}) node.remove_attribute(name);
    for (const Property& property : properties) {
      pugi::xml_attribute attribute = node.attribute(property.name.data());
      if (!attribute) continue;
      const std::string value = value_of(property.name, attribute.value(), variables);
      if (is_valid_svg_value(property.name, value))
        attribute.set_value(value.c_str());
      else
        node.remove_attribute(attribute);
    }
    for (const CssDeclaration* one : declarations) set(node, *one, variables);
    for (const Property& property : properties) resolve(node, property);
    return own;
  }

  /// The value without variables, its keywords in lower case. A variable that has no value makes
  /// the property "unset" (CSS Custom Properties, section 3.1).
  std::string value_of(std::string_view property, std::string_view text,
                       const CssVariables& variables) {
    std::string value(text);
    if (uses_variables(value)) {
      std::size_t characters = 0;
      value = with_variables(value, variables, characters).value_or("unset");
      spend(characters / characters_a_step);
    }
    return is_case_sensitive(property) ? value : with_lower_keywords(value);
  }

  void set(xml_node& node, const CssDeclaration& one, const CssVariables& variables) {
    if (one.name == "font") {
      const std::string value = value_of(one.name, one.value, variables);
      return set(node, {"font-size", std::string(size_of_font(value)), one.important}, {});
    }
    if (property_named(one.name) == nullptr) return;
    const std::string value = value_of(one.name, one.value, variables);
    if (is_size_of_window(node, one.name, value) || !is_valid_svg_value(one.name, value)) return;
    pugi::xml_attribute attribute = node.attribute(one.name.c_str());
    if (!attribute) attribute = node.append_attribute(one.name.c_str());
    attribute.set_value(value.c_str());
    if (one.name == "marker") set_markers(node, value);
  }

  /// Pages of the web give the drawing the size of their window; its own size is the attribute.
  static bool is_size_of_window(const xml_node& node, std::string_view name,
                                std::string_view value) {
    const bool is_size = name == "width" || name == "height";
    const bool is_root = node.parent().type() == pugi::node_document;
    return is_size && is_root &&
           (value == "auto" || value.ends_with('%') || value.ends_with("vw") ||
            value.ends_with("vh"));
  }

  static void set_markers(xml_node& node, const std::string& value) {
    for (const char* name : {"marker-start", "marker-mid", "marker-end"}) {
      pugi::xml_attribute attribute = node.attribute(name);
      if (!attribute) attribute = node.append_attribute(name);
      attribute.set_value(value.c_str());
    }
  }

  /// Replaces the keywords that all properties have. The parent's attributes are resolved already.
  static void resolve(xml_node& node, const Property& property) {
    pugi::xml_attribute attribute = node.attribute(property.name.data());
    if (!attribute) return;
    const std::string_view value = trimmed(attribute.value());
    const bool inherits = value == "inherit" || (value == "unset" && property.inherited) ||
                          ((value == "revert" || value == "revert-layer") && property.inherited);
    const bool is_initial =
        value == "initial" || value == "unset" || value == "revert" || value == "revert-layer";
    const bool is_default = inherits ? property.inherited : is_initial && property.initial.empty();
    if (is_default) {
      node.remove_attribute(attribute);
    } else if (inherits) {
      const std::string above = node.parent().attribute(property.name.data()).value();
      attribute.set_value(above.c_str());
    } else if (is_initial) {
      attribute.set_value(property.initial.data());
    }
  }

  StyleSheet sheet_;
  Index by_id_, by_class_, by_element_;
  StyleOutcome outcome_;
  std::size_t work_ = 0;
};

}  // namespace

std::string_view svg_name(const xml_node& node) { return node.name(); }

StyleOutcome apply_styles(const xml_node& root) { return Cascade().apply(root); }

}  // namespace lamplock::model
