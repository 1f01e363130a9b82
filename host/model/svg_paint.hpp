// What of an SVG element is visible (W3C, "Scalable Vector Graphics (SVG) 2", chapter 13).
//
// In:  attributes with resolved styles, the paint of the parent. Out: whether fill and stroke are
//      visible, the dashes of the stroke.
// Who: read_svg(), its clip paths.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "host/model/colour.hpp"
#include "host/model/curves.hpp"
#include "host/model/svg_document.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {

/// The inherited properties of painting, as computed for an element.
struct SvgPaint {
  bool is_visible = true;       ///< by the property visibility
  bool has_fill = true;         ///< black by default
  bool fill_is_default = true;  ///< no element has set it
  bool fill_is_white = false;   ///< the colour of the page
  bool fill_is_server = false;  ///< a gradient or pattern
  FillRule fill_rule = FillRule::non_zero;
  bool has_stroke = false;
  Colour fill_colour = 0, stroke_colour = no_colour;
  /// The property color, the value of the keyword currentColor where it is used.
  Colour current_colour = 0;
  bool current_is_white = false, current_is_visible = true;
  bool fill_is_current = false, stroke_is_current = false;
  double fill_opacity = 1, stroke_opacity = 1;
  double stroke_width = 1;       ///< user's units
  std::vector<double> dashes{};  ///< dash, gap, ... in user's units; empty: none
  double dash_offset = 0;
  bool has_long_ends = false;  ///< round or square line ends

  /// Of the line, otherwise of the area.
  Colour colour() const { return shows_stroke() ? stroke_colour : fill_colour; }
  bool shows_fill() const { return is_visible && has_fill && fill_opacity > 0; }
  bool shows_stroke() const {
    return is_visible && has_stroke && stroke_opacity > 0 && stroke_width > 0;
  }
};

/// False for a value that a property of painting cannot have: it is ignored, as in CSS. True for
/// all values of other properties.
bool is_valid_svg_value(std::string_view property, std::string_view text);

/// Replaces what the element sets itself.
void inherit_paint(const pugi::xml_node& node, const SvgUnits& units, const SvgDocument& document,
                   SvgPaint& paint);

/// True if a shape is drawn as the dashes of its stroke. The edge of a fill in another colour than
/// the page's is whole.
bool has_dashes(const pugi::xml_node& shape, const SvgPaint& paint);

/// True if the edge of a shape's fill is visible, also where no stroke is: open paths are closed.
bool shows_filled_edge(const pugi::xml_node& shape, const SvgPaint& paint);

/// True for display:none and an opacity of 0, which hide an element with all that is in it.
bool is_not_rendered(const pugi::xml_node& node);

/// An attribute without blanks at its ends.
std::string_view svg_value(const pugi::xml_node& node, const char* name);

}  // namespace lamplock::model
