#include "host/model/svg_views.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "host/model/svg_paint.hpp"
#include "host/model/svg_shapes.hpp"

namespace lamplock::model {

using pugi::xml_node;

namespace {

/// The sizes of the window, which a file does not know, and no size at all.
bool is_of_window(std::string_view size) {
  return size.empty() || size == "auto" || size.ends_with('%') || size.ends_with("vw") ||
         size.ends_with("vh") || size.ends_with("vmin") || size.ends_with("vmax");
}

}  // namespace

/// The page of a file is a replaced element of CSS: a side without a length of its own follows from
/// the other by the ratio of the view. Without any the page, the reference of percentages, has the
/// size of the view.
SvgBox svg_page(const xml_node& root, SvgUnits& units, const FilePosition& place) {
  const std::vector<double> view = svg_numbers(root.attribute("viewBox").value(), place);
  const bool has_view = view.size() == 4 && view[2] > 0 && view[3] > 0;
  const SvgBox whole{0, 0, has_view ? view[2] : 0, has_view ? view[3] : 0};
  units.port = whole;
  units.page_width_px = whole.width;
  units.page_height_px = whole.height;
  const std::string_view width = svg_value(root, "width"), height = svg_value(root, "height");
  const auto is_auto = [](std::string_view text) { return text.empty() || text == "auto"; };
  // A percentage is used if the other side has no length.
  const bool follows_x = is_of_window(width) && (!is_of_window(height) || is_auto(width));
  const bool follows_y = is_of_window(height) && (!is_of_window(width) || is_auto(height));
  SvgBox page{0, 0, svg_length_of(root, "width", whole.width, whole.width, units, place),
              svg_length_of(root, "height", whole.height, whole.height, units, place)};
  if (has_view && follows_x && !follows_y) page.width = page.height * whole.width / whole.height;
  if (has_view && follows_y && !follows_x) page.height = page.width * whole.height / whole.width;
  const bool is_empty = has_view && (page.width == 0 || page.height == 0);
  if (page.width < 0 || page.height < 0 || is_empty)
    place.refuse(fmt::format("the page has the size {} x {}", page.width, page.height),
                 "repair the drawing");
  units.page_width_px = page.width;
  units.page_height_px = page.height;
  return page;
}

SvgBox svg_view_port(const xml_node& node, const xml_node& use, const SvgUnits& units,
                     const FilePosition& place) {
  SvgBox port = svg_box_of(node, units, place);
  const SvgBox given = use ? svg_box_of(use, units, place) : SvgBox{};
  const auto has = [](const xml_node& one, const char* name) {
    const std::string_view text = svg_value(one, name);
    return !text.empty() && text != "auto";
  };
  const auto size = [&](const char* name, double of_use, double own, double whole) {
    return has(use, name) ? of_use : has(node, name) ? own : whole;
  };
  port.width = size("width", given.width, port.width, units.port.width);
  port.height = size("height", given.height, port.height, units.port.height);
  return port;
}

geometry::Affine svg_view_map(const xml_node& node, const SvgBox& port, SvgUnits& units,
                              const FilePosition& place) {
  units.port = port;
  const char* text = node.attribute("viewBox").value();
  if (*text == '\0') return geometry::moved(port.x, port.y, 0);
  const std::vector<double> view = svg_numbers(text, place);
  if (view.size() != 4 || !(view[2] > 0) || !(view[3] > 0))
    place.refuse(fmt::format("the viewBox '{:.40}' is not valid", text), "repair the drawing");
  units.port = {view[0], view[1], view[2], view[3]};
  return svg_fit(units.port, port, node.attribute("preserveAspectRatio").value());
}

}  // namespace lamplock::model
