#include "host/model/svg_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "host/letter_case.hpp"
#include "host/model/svg_paint.hpp"
#include "host/text.hpp"

namespace lamplock::model {

using pugi::xml_node;

bool svg_draws_nothing(std::string_view name) {
  constexpr std::array<std::string_view, 15> names{
      "defs",           "metadata", "title",    "desc",   "style",
      "script",         "symbol",   "clipPath", "mask",   "linearGradient",
      "radialGradient", "pattern",  "marker",   "filter", "view"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool svg_conditions_hold(const xml_node& node) {
  if (*node.attribute("requiredExtensions").value() != 0) return false;
  const pugi::xml_attribute attribute = node.attribute("systemLanguage");
  if (!attribute) return true;
  const std::string tags = in_lower_case(attribute.value());
  for (std::string_view rest = tags; !rest.empty();) {
    const std::string_view tag = trimmed(rest.substr(0, rest.find(',')));
    if (tag == "en" || tag.starts_with("en-")) return true;
    rest.remove_prefix(std::min(rest.find(','), rest.size() - 1) + 1);
  }
  return false;
}

xml_node svg_chosen_of(const xml_node& node) {
  for (const xml_node& child : node.children())
    if (child.type() == pugi::node_element && svg_conditions_hold(child)) return child;
  return {};
}

bool svg_has_markers(const xml_node& node) {
  for (const char* name : {"marker-start", "marker-mid", "marker-end"}) {
    const std::string_view value = svg_value(node, name);
    if (!value.empty() && value != "none") return true;
  }
  return false;
}

geometry::Affine svg_own_transform(const xml_node& node, const SvgUnits& units,
                                   const FilePosition& place) {
  geometry::Affine map;
  for (const char* name : {"translate", "rotate", "scale"}) {
    const std::string_view value = svg_value(node, name);
    if (value.empty() || value == "none") continue;
    map = map * svg_transform(fmt::format("{}({})", name, value), units, place);
  }
  return map * svg_transform(svg_value(node, "transform"), units, place);
}

geometry::Point svg_transform_origin(const xml_node& node, const SvgBox& box, const SvgUnits& units,
                                     const FilePosition& place) {
  const std::string_view origin = svg_value(node, "transform-origin");
  if (origin.empty()) return {box.x, box.y, 0};
  std::string_view x = origin.substr(0, origin.find(' '));
  std::string_view y =
      origin.substr(std::min(origin.find_first_not_of(' ', x.size()), origin.size()));
  y = y.substr(0, y.find(' '));
  if (x == "top" || x == "bottom" || y == "left" || y == "right") std::swap(x, y);
  const auto part = [&](std::string_view text, double whole) {
    if (text == "left" || text == "top") return 0.0;
    if (text == "center" || text.empty()) return whole / 2;
    if (text == "right" || text == "bottom") return whole;
    return svg_length(text, whole, units, place);
  };
  return {box.x + part(x, box.width), box.y + part(y, box.height), 0};
}

}  // namespace lamplock::model
