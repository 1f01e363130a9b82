#include "host/cli/shell_text.hpp"

#include <algorithm>
#include <string_view>

namespace lamplock::cli {
namespace {

/// Characters without a special meaning in any place of a word.
bool is_plain(char c) {
  constexpr std::string_view others = "_-./:,=+@%";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         others.find(c) != std::string_view::npos;
}

std::string word(const std::string& argument) {
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), is_plain)) return argument;
  std::string quoted = "'";
  for (const char c : argument) {
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted.push_back(c);
  }
  return quoted + "'";
}

}  // namespace

std::string shell_text(const std::string& program, const std::vector<std::string>& arguments) {
  std::string text = program;
  for (const std::string& argument : arguments) text += " " + word(argument);
  return text;
}

}  // namespace lamplock::cli
