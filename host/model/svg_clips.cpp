#include "host/model/svg_clips.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "host/model/curve_collector.hpp"
#include "host/model/svg_elements.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/model/svg_style.hpp"
#include "host/model/svg_views.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// The map from a box of 1 by 1 to that of an element.
geometry::Affine from_unit_box(const geometry::Bounds& box) {
  return geometry::moved(box.low.x, box.low.y, 0) *
         geometry::scaled(box.high.x - box.low.x, box.high.y - box.low.y, 1);
}

/// True if an element of a mask changes neither the colours nor the alpha of what is in it.
bool is_plain(const xml_node& node) {
  const std::string_view opacity = svg_value(node, "opacity"), filter = svg_value(node, "filter");
  return (filter.empty() || filter == "none") &&
         (opacity.empty() || find_svg_length(opacity, 1, {}).value_or(1) >= 1);
}

/// True if a shape of a mask lets everything through where it is, and nothing else is painted.
bool is_opaque(const SvgPaint& paint, bool is_alpha) {
  return paint.fill_opacity >= 1 && !paint.fill_is_server && paint.shows_fill() &&
         !paint.shows_stroke() && (is_alpha || paint.fill_is_white);
}

}  // namespace

bool SvgClips::needs_box(const xml_node& node) const {
  const auto refers_to_box = [](const xml_node& element, const char* units) {
    return svg_value(element, units) == "objectBoundingBox";
  };
  if (const xml_node mask = document_.find_url(svg_value(node, "mask"));
      mask &&
      (refers_to_box(mask, "maskContentUnits") || svg_value(mask, "maskUnits") != "userSpaceOnUse"))
    return true;
  xml_node clip = document_.find_url(svg_value(node, "clip-path"));
  for (int chain = 0; clip && chain < max_svg_depth; ++chain) {
    if (refers_to_box(clip, "clipPathUnits")) return true;
    clip = document_.find_url(svg_value(clip, "clip-path"));
  }
  return false;
}

bool SvgClips::append(const xml_node& node, const Frame& frame, ClipRegions& regions) {
  for (const bool is_mask : {false, true}) {
    const std::string_view value = svg_value(node, is_mask ? "mask" : "clip-path");
    if (value.empty() || value == "none") continue;
    if (!value.starts_with("url(")) return false;  // basic shapes of CSS
    const xml_node element = document_.find_url(value);
    // A reference to nothing clips nothing, as in SVG 2.
    if (!element || svg_name(element) != (is_mask ? "mask" : "clipPath")) continue;
    Region region = region_of(element, frame, is_mask);
    if (!region) return false;
    regions.push_back(std::move(region));
    if (is_mask && !append_mask_box(element, frame, regions)) return false;
    // The clip path may be clipped itself, in the same units.
    if (svg_name(element) != "clipPath") continue;
    open_.push_back(element);
    const bool applied = append(element, frame, regions);
    open_.pop_back();
    if (!applied) return false;
  }
  return true;
}

void SvgClips::append(const SvgBox& box, const geometry::Affine& map, const FilePosition& place,
                      ClipRegions& regions) {
  const geometry::Point a{box.x, box.y, 0}, b{box.x + box.width, box.y, 0},
      c{box.x + box.width, box.y + box.height, 0}, d{box.x, box.y + box.height, 0};
  const Path outline =
      CurveCollector::placed({{Line{a, b}, Line{b, c}, Line{c, d}, Line{d, a}}, true}, map, place);
  Shapes shapes;
  shapes.emplace_back(std::vector<Path>{outline}, false, ClipRegions{}, work_, place);
  regions.push_back(std::make_shared<const ClipRegion>(std::move(shapes)));
}

SvgClips::Region SvgClips::region_of(const xml_node& element, const Frame& frame, bool is_mask) {
  if (std::find(open_.begin(), open_.end(), element) != open_.end())
    document_.position_of(element).refuse(
        fmt::format("the clip path '{:.40}' uses itself", element.attribute("id").value()),
        "repair the drawing");
  const char* units = is_mask ? "maskContentUnits" : "clipPathUnits";
  const bool depends_on_box = svg_value(element, units) == "objectBoundingBox";
  if (depends_on_box && !frame.box) return nullptr;
  Frame own = frame;
  if (depends_on_box) {
    own.map = frame.map * from_unit_box(*frame.box);
    own.units.port = {0, 0, 1, 1};
  }
  // Many elements of a drawing refer to the same clip path in the same place.
  const auto known = known_.find(element.hash_value());
  if (known != known_.end() && known->second.map == own.map) return known->second.region;
  const geometry::Affine map = own.map;
  Region region = new_region(element, own, is_mask);
  known_[element.hash_value()] = {map, region};
  return region;
}

SvgClips::Region SvgClips::new_region(const xml_node& element, Frame frame, bool is_mask) {
  const FilePosition place = document_.position_of(element);
  frame.map = frame.map * svg_transform(svg_value(element, "transform"), frame.units, place);
  frame.box.reset();
  Inherited inherited;
  inherited.is_mask = is_mask;
  inherited.is_alpha = svg_value(element, "mask-type") == "alpha";
  // Properties come from the elements around it, lengths and places from the one that it clips.
  inherited.frame = frame;
  inherited.frame.units.font_px = SvgUnits{}.font_px;
  std::vector<xml_node> around{element};
  while (around.back().parent().type() == pugi::node_element)
    around.push_back(around.back().parent());
  for (auto one = around.rbegin(); one != around.rend(); ++one) inherit(*one, inherited);
  Shapes shapes;
  open_.push_back(element);
  const bool applied = add_children(element, inherited, shapes);
  open_.pop_back();
  return applied ? std::make_shared<const ClipRegion>(std::move(shapes)) : nullptr;
}

/// The box of a mask cuts it off. By default it is larger than the element.
bool SvgClips::append_mask_box(const xml_node& mask, const Frame& frame, ClipRegions& regions) {
  const FilePosition place = document_.position_of(mask);
  const bool in_user_units = svg_value(mask, "maskUnits") == "userSpaceOnUse";
  const bool has_box = mask.attribute("width") && mask.attribute("height");
  if (!has_box) return true;
  if (in_user_units) {
    append(svg_box_of(mask, frame.units, place), frame.map, place, regions);
    return true;
  }
  if (!frame.box) return false;
  SvgUnits units = frame.units;
  units.port = {0, 0, 1, 1};
  append(svg_box_of(mask, units, place), frame.map * from_unit_box(*frame.box), place, regions);
  return true;
}

void SvgClips::inherit(const xml_node& node, Inherited& inherited) const {
  SvgUnits& units = inherited.frame.units;
  units.font_px = svg_font_size(svg_value(node, "font-size"), units);
  inherit_paint(node, units, document_, inherited.paint);
  const char* name = inherited.is_mask ? "fill-rule" : "clip-rule";
  if (const std::string_view rule = svg_value(node, name); !rule.empty()) inherited.rule = rule;
}

/// Applies the properties of an element of a clip path or mask. False if one of them cannot be.
bool SvgClips::enter(const xml_node& node, Inherited& inherited) {
  const FilePosition place = document_.position_of(node);
  constexpr std::size_t tests_per_shape = 1000;  // reading one takes as long
  work_.spend(tests_per_shape, place);
  if (++inherited.depth > max_svg_depth)
    place.refuse(fmt::format("groups are nested deeper than {}", max_svg_depth), "ungroup some");
  inherit(node, inherited);
  Frame& frame = inherited.frame;
  frame.map = frame.map * svg_transform(svg_value(node, "transform"), frame.units, place);
  if (svg_name(node) == "use") {
    const SvgBox at = svg_box_of(node, frame.units, place);
    frame.map = frame.map * geometry::moved(at.x, at.y, 0);
  }
  return (!inherited.is_mask || is_plain(node)) && append(node, frame, inherited.clips);
}

bool SvgClips::is_hidden(const xml_node& node, const Inherited& inherited) {
  return inherited.is_mask ? is_not_rendered(node) : svg_value(node, "display") == "none";
}

bool SvgClips::add_children(const xml_node& node, const Inherited& inherited, Shapes& shapes) {
  for (const xml_node& child : node.children()) {
    if (child.type() == pugi::node_element && !add_element(child, inherited, shapes)) return false;
  }
  return true;
}

bool SvgClips::add_element(const xml_node& node, Inherited inherited, Shapes& shapes) {
  const std::string_view name = svg_name(node);
  if (svg_draws_nothing(name) || is_hidden(node, inherited) || !svg_conditions_hold(node))
    return true;
  if (name == "use") return add_use(node, std::move(inherited), shapes);
  // Clip paths have no groups.
  if (inherited.is_mask && name == "svg") return add_view(node, {}, std::move(inherited), shapes);
  if (inherited.is_mask && (name == "g" || name == "a" || name == "switch")) {
    if (!enter(node, inherited)) return false;
    if (name != "switch") return add_children(node, inherited, shapes);
    const xml_node chosen = svg_chosen_of(node);
    return !chosen || add_element(chosen, inherited, shapes);
  }
  return add_shape(node, std::move(inherited), shapes);
}

bool SvgClips::add_use(const xml_node& node, Inherited inherited, Shapes& shapes) {
  const xml_node used = document_.used_by(node);
  if (!used || std::find(open_.begin(), open_.end(), used) != open_.end()) return false;
  if (!enter(node, inherited)) return false;
  const std::string_view name = svg_name(used);
  const bool is_view = inherited.is_mask && (name == "symbol" || name == "svg");
  if (!is_view && svg_draws_nothing(name)) return false;
  open_.push_back(used);
  const bool applied = is_view ? add_view(used, node, std::move(inherited), shapes)
                               : add_element(used, std::move(inherited), shapes);
  open_.pop_back();
  return applied;
}

bool SvgClips::add_view(const xml_node& node, const xml_node& use, Inherited inherited,
                        Shapes& shapes) {
  if (is_hidden(node, inherited)) return true;
  if (!enter(node, inherited)) return false;
  const FilePosition place = document_.position_of(node);
  Frame& frame = inherited.frame;
  const SvgBox port = svg_view_port(node, use, frame.units, place);
  const bool has_size = frame.units.port.width > 0 && frame.units.port.height > 0;
  if (has_size && (port.width == 0 || port.height == 0)) return true;
  if (const std::string_view overflow = svg_value(node, "overflow");
      has_size && overflow != "visible" && overflow != "auto")
    append(port, frame.map, place, inherited.clips);
  frame.map = frame.map * svg_view_map(node, port, frame.units, place);
  return add_children(node, inherited, shapes);
}

bool SvgClips::add_shape(const xml_node& node, Inherited inherited, Shapes& shapes) {
  if (!enter(node, inherited)) return false;
  const FilePosition place = document_.position_of(node);
  const Frame& frame = inherited.frame;
  const SvgPaint& paint = inherited.paint;
  const auto paths = svg_shape(node, svg_name(node), frame.units, place);
  if (!paths) return false;  // text
  const bool is_painted = !inherited.is_mask || paint.shows_fill() || paint.shows_stroke();
  if (!paint.is_visible || !is_painted) return true;
  if (inherited.is_mask && !is_opaque(paint, inherited.is_alpha)) return false;
  std::vector<Path> outlines;
  for (const Path& path : *paths)
    outlines.push_back(CurveCollector::placed(path, frame.map, place));
  shapes.emplace_back(outlines, inherited.rule == "evenodd", inherited.clips, work_, place);
  return true;
}

}  // namespace lamplock::model
