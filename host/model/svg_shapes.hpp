// The basic shapes of SVG as curves (W3C, "Scalable Vector Graphics (SVG) 1.1", chapter 9; radii of
// rectangles as in SVG 2).
//
// In:  an element with the reference size of percentages. Out: its paths in its own units.
// Who: read_svg().
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "host/model/curves.hpp"
#include "host/model/file_position.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {

/// A length attribute in px; `otherwise` if there is none. Throws Error (bad_input).
double svg_length_of(const pugi::xml_node& node, const char* name, double whole_px,
                     double otherwise, const SvgUnits& units, const FilePosition& place);

/// The rectangle of attributes x, y, width and height; 0 for missing ones. Throws Error (bad_input)
/// for negative sizes.
SvgBox svg_box_of(const pugi::xml_node& node, const SvgUnits& units, const FilePosition& place);

/// What percentages of radii and dashes refer to: the diagonal over the root of 2.
double svg_diagonal(const SvgBox& port);

/// The paths of path, rect, circle, ellipse, line, polyline and polygon, by `name`; empty for any
/// other element. Shapes without extent have no path. Throws Error (bad_input) naming the place.
std::optional<std::vector<Path>> svg_shape(const pugi::xml_node& node, std::string_view name,
                                           const SvgUnits& units, const FilePosition& place);

}  // namespace lamplock::model
