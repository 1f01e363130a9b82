#include "host/model/svg_style.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/model/css.hpp"
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
constexpr std::array<Property, 40> properties{{{"display", false, "inline"},
                                               {"visibility", true, "visible"},
                                               {"opacity", false, "1"},
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
    apply_below(root);
    outcome_.unread_rules = sheet_.unread;
    return outcome_;
  }

 private:
  using Index = std::unordered_map<std::string, std::vector<std::size_t>>;

  void read_sheets(const xml_node& node) {
    if (svg_name(node) == "style") {
      const std::string_view type = node.attribute("type").value();
      if (!type.empty() && type != "text/css") return;
      if (!is_for_screens(node.attribute("media").value())) {
        ++sheet_.unread;
        return;
      }
      std::string text;
      for (const xml_node& child : node.children()) text += child.value();
      read_css(text, sheet_);
    }
    for (const xml_node& child : node.children()) read_sheets(child);
  }

  void apply_below(const xml_node& node) {
    if (outcome_.too_complex) return;
    if (node.type() == pugi::node_element) apply_to(node);
    for (const xml_node& child : node.children()) apply_below(child);
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

  void apply_to(xml_node node) {
    // Attributes with these names belong to text and filters.
    for (const char* name : {"translate", "rotate", "scale"}) node.remove_attribute(name);
    for (const Property& property : properties) {
      const pugi::xml_attribute attribute = node.attribute(property.name.data());
      if (attribute && !is_valid_svg_value(property.name, attribute.value()))
        node.remove_attribute(attribute);
    }
    const std::vector<std::size_t> selectors = selectors_of(node);
    const std::vector<CssDeclaration> own = css_declarations(node.attribute("style").value());
    for (const bool important : {false, true}) {
      for (const std::size_t selector : selectors)
        set_all(node, sheet_.declarations[sheet_.selectors[selector].declarations], important);
      set_all(node, own, important);
    }
    for (const Property& property : properties) resolve(node, property);
  }

  void set_all(xml_node& node, const std::vector<CssDeclaration>& declarations, bool important) {
    if (!spend(declarations.size())) return;
    for (const CssDeclaration& one : declarations) {
      if (one.important != important || property_named(one.name) == nullptr) continue;
      if (is_size_of_window(node, one) || !is_valid_svg_value(one.name, one.value)) continue;
      pugi::xml_attribute attribute = node.attribute(one.name.c_str());
      if (!attribute) attribute = node.append_attribute(one.name.c_str());
      attribute.set_value(one.value.c_str());
      if (one.name == "marker") set_markers(node, one.value);
    }
  }

  /// Pages of the web give the drawing the size of their window; its own size is the attribute.
  static bool is_size_of_window(const xml_node& node, const CssDeclaration& one) {
    const bool is_size = one.name == "width" || one.name == "height";
    const bool is_root = node.parent().type() == pugi::node_document;
    return is_size && is_root &&
           (one.value == "auto" || one.value.ends_with('%') || one.value.ends_with("vw") ||
            one.value.ends_with("vh"));
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
