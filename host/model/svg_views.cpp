#include "host/model/svg_views.hpp"

#include <fmt/format.h>

#include <vector>

#include "host/model/svg_shapes.hpp"

namespace lamplock::model {

using pugi::xml_node;

/// Without a size the page, the reference of percentages, has that of the view.
SvgBox svg_page(const xml_node& root, SvgUnits& units, const FilePosition& place) {
  const std::vector<double> view = svg_numbers(root.attribute("viewBox").value(), place);
  const bool has_view = view.size() == 4;
  const SvgBox whole{0, 0, has_view ? view[2] : 0, has_view ? view[3] : 0};
  units.port = whole;
  units.page_width_px = whole.width;
  units.page_height_px = whole.height;
  const SvgBox page{0, 0, svg_length_of(root, "width", whole.width, whole.width, units, place),
                    svg_length_of(root, "height", whole.height, whole.height, units, place)};
  const bool is_empty = has_view && (page.width == 0 || page.height == 0);
  if (page.width < 0 || page.height < 0 || is_empty)
    place.refuse(fmt::format("the page has the size {} x {}", page.width, page.height),
                 "repair the drawing");
  units.page_width_px = page.width;
  units.page_height_px = page.height;
  return page;
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
