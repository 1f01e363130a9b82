// Text entities of a DXF (Autodesk, "DXF Reference": TEXT, ATTRIB, MTEXT).
//
// In:  the groups of one entity. Out: its lines of text and their place, in the units of the
//      drawing.
// Who: read_dxf().
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/model/dxf_groups.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::model {

/// The text of a TEXT, ATTRIB or MTEXT; empty for any other kind and for text without a visible
/// character. Throws Error (bad_input) for a height that is not positive.
std::optional<TextBlock> dxf_text(const DxfGroups& dxf, const DxfEntity& entity);

/// The characters of a TEXT in UTF-8: codes such as %%d (degrees) and \U+2300 are replaced. Bytes
/// that are not UTF-8 are taken as ISO 8859-1.
std::string dxf_characters(std::string_view value);

/// The lines of an MTEXT without its formatting codes.
std::vector<std::string> dxf_lines(std::string_view value);

}  // namespace lamplock::model
