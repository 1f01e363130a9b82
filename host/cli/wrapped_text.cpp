#include "host/cli/wrapped_text.hpp"

#include <unistd.h>

#include <algorithm>

#include "host/cli/live_line.hpp"

namespace lamplock::cli {
namespace {

constexpr std::size_t further_indent = 2;

std::string wrapped_line(std::string_view line, std::size_t columns) {
  const bool has_command = line.find("lamplock ") != std::string_view::npos;
  if (has_command || text_columns(line) <= columns) return std::string(line);
  const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
  std::string result, row(indent, ' ');
  bool is_begun = false;
  for (std::size_t at = indent; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    // Blanks before the word belong to it, so that columns of a table stay where they fit.
    const std::size_t next = std::min(line.find_first_not_of(' ', end), line.size());
    const std::string_view word = line.substr(at, end - at);
    if (is_begun && text_columns(row) + text_columns(word) > columns) {
      result += row.substr(0, row.find_last_not_of(' ') + 1) + '\n';
      row.assign(indent + further_indent, ' ');
    }
    row += word;
    row.append(next - end, ' ');
    is_begun = true;
    at = next;
  }
  return result + row.substr(0, row.find_last_not_of(' ') + 1);
}

}  // namespace

std::size_t text_columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char byte) {
    constexpr unsigned continuation_mask = 0xC0, continuation = 0x80;
    return (static_cast<unsigned char>(byte) & continuation_mask) != continuation;
  }));
}

std::string wrapped_text(std::string_view text, std::size_t columns) {
  std::string result;
  while (true) {
    const std::size_t end = text.find('\n');
    result += wrapped_line(text.substr(0, end), columns);
    if (end == std::string_view::npos) return result;
    result += '\n';
    text.remove_prefix(end + 1);
  }
}

std::string wrapped_for(std::FILE* out, std::string_view text) {
  if (::isatty(::fileno(out)) != 1) return std::string(text);
  // A character in the last column would leave some terminals between two rows.
  return wrapped_text(text, columns_of(out) - 1);
}

}  // namespace lamplock::cli
