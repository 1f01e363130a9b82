// View ports of SVG: the page and the coordinates in nested ones (W3C, "Scalable Vector Graphics
// (SVG) 2", chapter 8).
//
// In:  an svg or symbol with its attributes. Out: its size in px, the map from its coordinates.
// Who: read_svg(), its clip paths.
#pragma once

#include <pugixml.hpp>

#include "host/geometry/affine.hpp"
#include "host/model/file_position.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {

/// The page of the outermost svg in px; sets what vw and vh of `units` refer to. Throws Error
/// (bad_input) naming the place for sizes that are not valid.
SvgBox svg_page(const pugi::xml_node& root, SvgUnits& units, const FilePosition& place);

/// The view port of a nested svg or symbol, in the units outside of it. Each size is that of `use`
/// (null if it is not used) where this has it, otherwise the node's own, otherwise 100 %. Throws
/// Error (bad_input) naming the place for sizes that are not valid.
SvgBox svg_view_port(const pugi::xml_node& node, const pugi::xml_node& use, const SvgUnits& units,
                     const FilePosition& place);

/// The map from the coordinates in a node, those of its viewBox if it has one, fitted into `port`;
/// percentages of `units` refer to these afterwards. Throws Error (bad_input) naming the place for
/// an invalid viewBox.
geometry::Affine svg_view_map(const pugi::xml_node& node, const SvgBox& port, SvgUnits& units,
                              const FilePosition& place);

}  // namespace lamplock::model
