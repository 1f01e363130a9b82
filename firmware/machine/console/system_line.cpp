#include "firmware/machine/console/system_line.hpp"

#include "shared/line_comments.hpp"

namespace lamplock::machine {
namespace {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Whether the characters of a line outside blanks and comments begin with these, in either case.
bool begins_with(std::string_view line, std::string_view begin) {
  std::size_t matched = 0;
  bool in_comment = false;
  for (std::size_t i = 0; i < line.size() && matched < begin.size(); ++i) {
    const char c = line[i];
    if (in_comment || c == '(') {
      in_comment = c != ')';
    } else if (!is_blank(c)) {
      if (upper(c) != begin[matched++]) return false;
    }
  }
  return matched == begin.size();
}

}  // namespace

bool is_jog(std::string_view line) { return begins_with(line, "$J="); }

std::string_view plain_system_line(std::span<char> line) {
  const std::string_view typed(line.data(), line.size());
  const bool has_text = begins_with(typed, "$I=") || begins_with(typed, "$N");
  std::size_t text = has_text ? 0 : line.size();  // where it begins
  while (text < line.size() && line[text] != '=') ++text;
  std::size_t size = 0;
  for (const char c : line.first(drop_comments(line.first(text)).size))
    if (!is_blank(c)) line[size++] = upper(c);
  for (; text < line.size(); ++text) line[size++] = line[text];
  return {line.data(), size};
}

}  // namespace lamplock::machine
