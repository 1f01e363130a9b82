// Characters in UTF-8.
//
// In:  code points of Unicode. Out: their bytes.
// Who: xml_in_utf8(), expand_entities().
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lamplock::model {

/// Replaces what is not a character.
inline constexpr std::uint32_t replacement_character = 0xFFFD;

/// Appends a character; U+FFFD for surrogates and values beyond Unicode.
void append_utf8(std::string& text, std::uint32_t code);

/// The character of a reference in XML by what is between "&#" and ";": decimal, or hexadecimal
/// after an x. U+FFFD for other text.
std::string character_reference(std::string_view digits);

}  // namespace lamplock::model
