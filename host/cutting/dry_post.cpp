#include "host/cutting/dry_post.hpp"

#include <cctype>
#include <cstddef>
#include <string>

namespace lamplock::cutting {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Length of the word M7 or M8 (also M07, m 8) at this place; 0 if there is another one.
std::size_t air_word_length(const std::string& line, std::size_t at) {
  if (line[at] != 'M' && line[at] != 'm') return 0;
  std::size_t digit = line.find_first_not_of(" 0", at + 1);
  if (digit == std::string::npos || (line[digit] != '7' && line[digit] != '8')) return 0;
  ++digit;
  const bool is_longer = digit < line.size() && (is_digit(line[digit]) || line[digit] == '.');
  return is_longer ? 0 : digit - at;
}

std::string without_air_words(const std::string& line) {
  std::string rest;
  char until = 0;  // end of a comment or of a value of the template
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (until != 0) {
      if (c == until) until = 0;
    } else if (c == ';') {
      return rest + line.substr(i);
    } else if (c == '(' || c == '{') {
      until = c == '(' ? ')' : '}';
    } else if (const std::size_t length = air_word_length(line, i); length > 0) {
      i += length - 1;
      if (rest.ends_with(' ')) rest.pop_back();
      continue;
    }
    rest += c;
  }
  return rest;
}

}  // namespace

Post without_air(Post post) {
  for (std::vector<std::string>& lines : post.lines)
    for (std::string& line : lines) line = without_air_words(line);
  return post;
}

}  // namespace lamplock::cutting
