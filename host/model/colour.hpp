// Colours of curves, by which a job chooses what is done along them.
//
// In:  texts of SVG files and descriptions, numbers of DXF files. Out: colours.
// Who: the readers of curves, the use case of cutting.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::model {

using Colour = std::uint32_t;  ///< 0xRRGGBB
inline constexpr Colour no_colour = 0xFFFFFFFF;

/// "#f00", "#ff0000", "red", and functions in sRGB (colour_function.hpp), also with an icc-color()
/// after them; empty for any other text. An alpha does not matter.
std::optional<Colour> colour_named(std::string_view text);

/// "#ff0000"; empty for no_colour.
std::string colour_text(Colour colour);

/// Colour 1..255 of AutoCAD's index; 7, which is white on black and black on white, is black.
std::optional<Colour> colour_of_aci(int number);

}  // namespace lamplock::model
