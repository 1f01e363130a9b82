#include "host/model/svg_namespaces.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_attribute;
using pugi::xml_node;

constexpr std::string_view inkscape_uri = "http://www.inkscape.org/namespaces/inkscape";
constexpr std::string_view xlink_uri = "http://www.w3.org/1999/xlink";

/// The namespace of SVG as it is and as people type it.
bool is_svg_uri(std::string_view uri) {
  uri = trimmed(uri);
  if (uri.ends_with('/')) uri.remove_suffix(1);
  return uri == "http://www.w3.org/2000/svg" || uri == "https://www.w3.org/2000/svg";
}

struct Name {
  std::string_view prefix, local;
};

Name name_of(std::string_view name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) return {{}, name};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

bool is_part_of_drawings(std::string_view local) {
  constexpr std::array<std::string_view, 14> names{
      "g",    "a",    "svg",  "use",   "switch", "symbol",   "path",
      "rect", "line", "text", "image", "circle", "polyline", "polygon"};
  return local == "ellipse" || std::find(names.begin(), names.end(), local) != names.end();
}

/// Elements of SVG in which those of others are expected.
bool may_hold_others(std::string_view local) {
  return local == "metadata" || local == "foreignObject" || local == "defs" || local == "title" ||
         local == "desc" || local == "script";
}

class Namespaces {
 public:
  NamespaceOutcome apply(xml_node root, int max_depth) {
    max_depth_ = max_depth;
    declare(root);
    const Name name = name_of(root.name());
    outcome_.root_uri = uri_of(name.prefix);
    has_namespace_ = !outcome_.root_uri.empty();
    outcome_.is_svg = name.local == "svg" && is_svg(name.prefix);
    if (outcome_.is_svg) enter(root, 0, true);
    return std::move(outcome_);
  }

 private:
  /// The namespace of a prefix, empty without a declaration.
  std::string uri_of(std::string_view prefix) const {
    const auto found = uris_.find(std::string(prefix));
    if (found != uris_.end() && !found->second.empty()) return found->second.back();
    return prefix == "svg" ? "http://www.w3.org/2000/svg" : "";
  }

  bool is_svg(std::string_view prefix) const {
    const std::string uri = uri_of(prefix);
    return is_svg_uri(uri) || (uri.empty() && prefix.empty() && !has_namespace_);
  }

  /// The prefixes that an element declares.
  std::vector<std::string> declare(const xml_node& node) {
    std::vector<std::string> declared;
    for (const xml_attribute& attribute : node.attributes()) {
      const Name name = name_of(attribute.name());
      const bool is_default = name.prefix.empty() && name.local == "xmlns";
      if (!is_default && name.prefix != "xmlns") continue;
      declared.emplace_back(is_default ? std::string_view{} : name.local);
      uris_[declared.back()].emplace_back(attribute.value());
    }
    return declared;
  }

  void enter_children(const xml_node& node, int depth, bool is_counted) {
    for (xml_node child = node.first_child(); child;) {
      const xml_node next = child.next_sibling();
      if (child.type() == pugi::node_element && !keep(child, depth, is_counted)) {
        xml_node parent = node;
        parent.remove_child(child);
      }
      child = next;
    }
  }

  /// False if an element is not one of SVG.
  bool keep(xml_node node, int depth, bool is_counted) {
    const std::vector<std::string> declared = declare(node);
    const Name name = name_of(node.name());
    const bool is_kept = is_svg(name.prefix);
    if (is_kept)
      enter(node, depth, is_counted);
    else if (is_counted && (name.prefix.empty() || is_part_of_drawings(name.local)))
      ++outcome_.foreign;
    for (const std::string& prefix : declared) uris_[prefix].pop_back();
    return is_kept;
  }

  void enter(xml_node node, int depth, bool is_counted) {
    for (xml_attribute attribute : node.attributes()) name_usually(attribute);
    const std::string local(name_of(node.name()).local);
    if (local != node.name()) node.set_name(local.c_str());
    const bool counts_children = is_counted && !may_hold_others(local);
    if (depth < max_depth_) enter_children(node, depth + 1, counts_children);
  }

  /// Gives an attribute the prefix that the reader knows.
  void name_usually(xml_attribute& attribute) const {
    const Name name = name_of(attribute.name());
    if (name.prefix.empty() || name.prefix == "xmlns") return;
    const bool is_link = name.local == "href";
    if (!is_link && name.local != "label" && name.local != "groupmode") return;
    const std::string usual = is_link ? "xlink" : "inkscape";
    if (name.prefix == usual || uri_of(name.prefix) != (is_link ? xlink_uri : inkscape_uri)) return;
    attribute.set_name((usual + ":" + std::string(name.local)).c_str());
  }

  int max_depth_ = 0;
  bool has_namespace_ = false;
  std::unordered_map<std::string, std::vector<std::string>> uris_;
  NamespaceOutcome outcome_;
};

}  // namespace

NamespaceOutcome keep_svg_elements(xml_node root, int max_depth) {
  return Namespaces().apply(root, max_depth);
}

}  // namespace lamplock::model
