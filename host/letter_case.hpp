// Letters in lower and upper case, independent of the locale: only A to Z and a to z change, so
// that texts in UTF-8 stay valid. Called by readers of files, lines and names in which case has no
// meaning.
#pragma once

#include <string>
#include <string_view>

namespace lamplock {

constexpr char lower_case(char letter) {
  return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
}
constexpr char upper_case(char letter) {
  return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
}

inline std::string in_lower_case(std::string_view text) {
  std::string result(text);
  for (char& letter : result) letter = lower_case(letter);
  return result;
}
inline std::string in_upper_case(std::string_view text) {
  std::string result(text);
  for (char& letter : result) letter = upper_case(letter);
  return result;
}

}  // namespace lamplock
