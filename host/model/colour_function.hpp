// Colour functions of CSS in sRGB: rgb(), hsl() and hwb() (W3C, "CSS Color Module Level 4").
//
// In:  the text of a function. Out: its colour. Who: colour_named().
#pragma once

#include <optional>
#include <string_view>

#include "host/model/colour.hpp"

namespace lamplock::model {

/// "rgb(255, 0, 0)", "rgb(100% 0% 0% / 50%)", "hsl(120deg 100% 50%)", "hwb(0.5turn 0% 0%)", also
/// rgba() and hsla(), in lower case; empty for any other text. An alpha does not matter; values out
/// of range are clamped.
std::optional<Colour> colour_of_function(std::string_view text);

}  // namespace lamplock::model
