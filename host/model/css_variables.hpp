// Variables of style sheets: `--name: value` and `var(--name, otherwise)` (W3C, "CSS Custom
// Properties for Cascading Variables Module Level 1").
//
// In:  the variables of an element, a value. Out: the value with what they have.
// Who: apply_styles() of SVG.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::model {

/// Values by name ("--name", case-sensitive).
using CssVariables = std::map<std::string, std::string, std::less<>>;

bool uses_variables(std::string_view value);

/// The value with every var() replaced. No value if a variable without an alternative is missing,
/// if variables use each other in a circle, or if it is longer than any value of a drawing. Adds
/// the characters that were read to `characters`.
std::optional<std::string> with_variables(std::string_view value, const CssVariables& variables,
                                          std::size_t& characters);

}  // namespace lamplock::model
