#include "host/error.hpp"

#include <algorithm>
#include <string_view>

#include "host/printable.hpp"

namespace lamplock {
namespace {

/// A longer word, such as a name of a thousand letters, and a longer part of an error hide the rest
/// of the message on a terminal.
constexpr std::size_t max_word_bytes = 200, max_part_bytes = 1200;
constexpr std::string_view gap = "...";

bool is_inside_character(char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; }

/// The begin and the end of a text that is longer than `max`; no character is cut.
std::string shortened(std::string_view text, std::size_t max) {
  if (text.size() <= max) return std::string(text);
  std::size_t begin = (max - gap.size()) * 2 / 3, end = text.size() - (max - gap.size() - begin);
  while (begin > 0 && is_inside_character(text[begin])) --begin;
  while (end < text.size() && is_inside_character(text[end])) ++end;
  return std::string(text.substr(0, begin)).append(gap).append(text.substr(end));
}

/// A printable part of an error with its long words shortened.
std::string part(const std::string& raw) {
  const std::string all = printable(raw);
  std::string text;
  std::string_view rest = all;
  while (!rest.empty()) {
    const std::size_t size = std::min(rest.find(' '), rest.size());
    text += shortened(rest.substr(0, size), max_word_bytes);
    rest.remove_prefix(size);
    if (rest.empty()) break;
    text += ' ';
    rest.remove_prefix(1);
  }
  return shortened(text, max_part_bytes);
}

}  // namespace

Error::Error(Exit exit, const std::string& where, const std::string& what,
             const std::string& remedy)
    : std::runtime_error(std::string(prefix) + (where.empty() ? "''" : part(where)) + ": " +
                         part(what) + "; " + part(remedy)),
      exit_(exit) {}

}  // namespace lamplock
