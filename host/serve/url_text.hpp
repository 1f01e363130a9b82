// Names in the address of a request. Called by the server's interfaces for files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lamplock::serve {

/// "my%20part" is "my part" (RFC 3986, section 2.1). Other characters stay as they are.
inline std::string decoded(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  const auto digit = [&](char c) { return digits.find(static_cast<char>(c | 0x20)); };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_code = text[i] == '%' && i + 2 < text.size() &&
                         digit(text[i + 1]) != digits.npos && digit(text[i + 2]) != digits.npos;
    if (!is_code) {
      result += text[i];
      continue;
    }
    result += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
    i += 2;
  }
  return result;
}

}  // namespace lamplock::serve
