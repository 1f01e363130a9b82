// Numbers in reports, as the datasheet writes them: 0x and a fixed number of digits.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lamplock::sim::chip {

inline std::string hex(std::uint32_t value, unsigned digits = 8) {
  constexpr std::string_view alphabet = "0123456789abcdef";
  std::string text(2 + digits, 'x');
  text[0] = '0';
  for (unsigned i = 0; i < digits; ++i) text[1 + digits - i] = alphabet[value >> (4 * i) & 15u];
  return text;
}

}  // namespace lamplock::sim::chip
