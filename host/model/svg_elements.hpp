// What single elements and attributes of an SVG mean, without what is in them.
//
// In:  an element with resolved styles. Out: whether it draws, its transform, the chosen child.
// Who: read_svg().
#pragma once

#include <pugixml.hpp>
#include <string_view>

#include "host/geometry/affine.hpp"
#include "host/model/file_position.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {

/// True for elements that draw nothing by themselves, by their name.
bool svg_draws_nothing(std::string_view name);

/// False if an element is for other programs or readers by its conditional attributes: no extension
/// is known, and the language is English.
bool svg_conditions_hold(const pugi::xml_node& node);

/// The first element of a `switch` whose conditions hold.
pugi::xml_node svg_chosen_of(const pugi::xml_node& node);

bool svg_has_markers(const pugi::xml_node& node);

/// The single transforms of CSS and the transform attribute, before the origin is applied. Throws
/// Error (bad_input) naming the place.
geometry::Affine svg_own_transform(const pugi::xml_node& node, const SvgUnits& units,
                                   const FilePosition& place);

/// The point that transforms refer to, in the element's units; `box` is that of percentages.
geometry::Point svg_transform_origin(const pugi::xml_node& node, const SvgBox& box,
                                     const SvgUnits& units, const FilePosition& place);

}  // namespace lamplock::model
