#include "host/printable.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace lamplock {
namespace {

/// A character and its number of bytes; 0 bytes if it is not valid UTF-8.
struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};

/// Decodes by RFC 3629: sequences by their first byte, the smallest code of each length; no
/// surrogates.
Character first_of(std::string_view text) {
  struct Form {
    std::uint8_t mask, mark;
    std::uint32_t least;
  };
  constexpr std::array<Form, 4> forms{
      {{0x80, 0x00, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}}};
  const auto byte = [text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  for (std::size_t more = 0; more < forms.size(); ++more) {
    const Form& form = forms[more];
    if ((byte(0) & form.mask) != form.mark) continue;
    if (text.size() <= more) return {};
    std::uint32_t code = byte(0) & static_cast<std::uint8_t>(~form.mask);
    for (std::size_t i = 1; i <= more; ++i) {
      if ((byte(i) & 0xc0) != 0x80) return {};
      code = code << 6 | (byte(i) & 0x3fu);
    }
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    if (code < form.least || code > 0x10ffff || surrogate) return {};
    return {code, more + 1};
  }
  return {};
}

/// False for controls (C0, DEL, C1), separators of lines, marks of direction, the byte order mark
/// and non-characters: Unicode 15, chapter 23.
bool is_harmless(std::uint32_t code) {
  struct Range {
    std::uint32_t first, last;
  };
  constexpr std::array<Range, 8> harmful{{{0x00, 0x1f},
                                          {0x7f, 0x9f},
                                          {0x061c, 0x061c},
                                          {0x200b, 0x200f},
                                          {0x2028, 0x202e},
                                          {0x2060, 0x206f},
                                          {0xfeff, 0xfeff},
                                          {0xfff0, 0xfffb}}};
  for (const Range& range : harmful)
    if (code >= range.first && code <= range.last) return false;
  return (code & 0xfffe) != 0xfffe;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = first_of(text).bytes;
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const Character next = first_of(text);
    if (next.bytes == 0) {
      fmt::format_to(std::back_inserter(line), "\\x{:02x}", static_cast<std::uint8_t>(text[0]));
    } else if (text[0] == '\n' || text[0] == '\t') {
      line += ' ';
    } else if (is_harmless(next.code)) {
      line += text.substr(0, next.bytes);
    } else if (next.code < 0x80) {
      fmt::format_to(std::back_inserter(line), "\\x{:02x}", next.code);
    } else {
      fmt::format_to(std::back_inserter(line), "\\u{{{:04x}}}", next.code);
    }
    text.remove_prefix(next.bytes == 0 ? 1 : next.bytes);
  }
  return line;
}

}  // namespace lamplock
