#include "host/model/dxf_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "host/geometry/vector.hpp"
#include "host/model/dxf_entities.hpp"
#include "host/model/utf8.hpp"

namespace lamplock::model {
namespace {

using geometry::Affine;
using geometry::Point;

/// The number of bytes of the character in UTF-8 at the begin of a text; 0 if it is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (byte(i) >> 6U != 2) return 0;
  return length;
}

std::string in_utf8(std::string_view bytes) {
  bool is_utf8 = true;
  for (std::size_t i = 0; i < bytes.size() && is_utf8;) {
    const std::size_t length = utf8_length(bytes.substr(i));
    is_utf8 = length != 0;
    i += length;
  }
  if (is_utf8) return std::string(bytes);
  std::string text;
  for (const char c : bytes) append_utf8(text, static_cast<unsigned char>(c));
  return text;
}

/// The value of this many digits at a place; none if there are fewer.
std::optional<std::uint32_t> digits_at(std::string_view text, std::size_t at, std::size_t count,
                                       std::uint32_t base) {
  if (at + count > text.size()) return std::nullopt;
  std::uint32_t value = 0;
  for (const char c : text.substr(at, count)) {
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                             : 99;
    if (digit >= static_cast<int>(base)) return std::nullopt;
    value = value * base + static_cast<std::uint32_t>(digit);
  }
  return value;
}

/// Appends what a code beginning with %% means; returns the number of bytes of the code, 0 if it is
/// none.
std::size_t append_percent_code(std::string& text, std::string_view rest) {
  constexpr std::uint32_t degrees = 0xB0, plus_minus = 0xB1, diameter = 0xD8;
  if (!rest.starts_with("%%") || rest.size() < 3) return 0;
  switch (rest[2]) {
    case 'd':
    case 'D':
      append_utf8(text, degrees);
      return 3;
    case 'p':
    case 'P':
      append_utf8(text, plus_minus);
      return 3;
    case 'c':
    case 'C':
      append_utf8(text, diameter);
      return 3;
    case '%':
      text += '%';
      return 3;
    case 'u':
    case 'U':
    case 'o':
    case 'O':
    case 'k':
    case 'K':
      return 3;  // lines along the text begin or end
    default:
      break;
  }
  const auto code = digits_at(rest, 2, 3, 10);
  if (!code) return 0;
  append_utf8(text, *code);
  return 5;
}

/// Appends the character of a code \U+2300; returns its number of bytes, 0 if it is none.
std::size_t append_unicode(std::string& text, std::string_view rest) {
  constexpr std::size_t prefix = 3, digits = 4;
  if (!rest.starts_with("\\U+")) return 0;
  const auto code = digits_at(rest, prefix, digits, 16);
  if (!code) return 0;
  append_utf8(text, *code);
  return prefix + digits;
}

/// Removes the formatting codes of an MTEXT.
class PlainLines {
 public:
  explicit PlainLines(std::string_view value) : rest_(value) {}

  std::vector<std::string> lines() {
    while (!rest_.empty()) read();
    return std::move(lines_);
  }

 private:
  std::string& line() { return lines_.back(); }

  void read() {
    std::size_t used = append_unicode(line(), rest_);
    if (used == 0) used = append_percent_code(line(), rest_);
    if (used != 0) return rest_.remove_prefix(used);
    const char c = rest_.front();
    if (c == '\\' && rest_.size() > 1) return read_code();
    if (c == '^' && rest_.size() > 1) {  // control characters: ^I is a tab, ^J ends a line
      if (rest_[1] == 'J') lines_.emplace_back();
      if (rest_[1] != 'J' && rest_[1] != 'M') line() += rest_[1] == ' ' ? '^' : ' ';
      return rest_.remove_prefix(2);
    }
    if (c != '{' && c != '}') line() += c;
    rest_.remove_prefix(1);
  }

  void read_code() {
    const char code = rest_[1];
    rest_.remove_prefix(2);
    switch (code) {
      case 'P':
      case 'X':
      case 'N':  // the next column
        lines_.emplace_back();
        return;
      case '~':
        append_utf8(line(), 0xA0);
        return;
      case 'L':
      case 'l':
      case 'O':
      case 'o':
      case 'K':
      case 'k':
        return;
      case 'S':
        return read_stack();
      case 'A':
      case 'C':
      case 'c':
      case 'F':
      case 'f':
      case 'H':
      case 'Q':
      case 'T':
      case 'W':
      case 'p':
        rest_.remove_prefix(std::min(rest_.find(';'), rest_.size() - 1) + 1);
        return;
      default:
        line() += code;  // a brace, a backslash
    }
  }

  /// \S1/2; is a fraction, \S+0.1^-0.2; two values above each other: both are written in one line.
  void read_stack() {
    const std::size_t end = std::min(rest_.find(';'), rest_.size());
    std::string stack(rest_.substr(0, end));
    std::replace(stack.begin(), stack.end(), '^', '/');
    std::replace(stack.begin(), stack.end(), '#', '/');
    line() += stack;
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
  }

  std::string_view rest_;
  std::vector<std::string> lines_{1};
};

bool is_blank(const std::vector<std::string>& lines) {
  return std::all_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find_first_not_of(" \t") == std::string::npos;
  });
}

double height_of(const DxfGroups& dxf, const DxfEntity& entity) {
  const double height = dxf.number(entity, 40);
  if (height > 0) return height;
  dxf.position_of(entity.kind)
      .refuse("the height of the text is not positive", "repair the drawing");
}

TextAnchor anchor_of(int number) {
  constexpr TextAnchor anchors[] = {TextAnchor::baseline, TextAnchor::bottom, TextAnchor::middle,
                                    TextAnchor::top};
  return number >= 0 && number < 4 ? anchors[number] : TextAnchor::baseline;
}

/// A text of one line: TEXT, ATTRIB.
TextBlock line_text(const DxfGroups& dxf, const DxfEntity& entity) {
  enum Justification { left, centre, right, aligned, middle, fit };
  constexpr int backwards = 2, upside_down = 4;
  constexpr double max_oblique_deg = 85;
  TextBlock block;
  block.lines = {dxf_characters(dxf.text(entity, 1))};
  const int across = dxf.integer(entity, 72);
  const int up = dxf.integer(entity, entity.kind == "ATTRIB" ? 74 : 73);
  const double height = height_of(dxf, entity);
  const Point first = dxf.point(entity, 10), second = dxf.point(entity, 11, first);
  Point at = first;
  double degrees = dxf.number(entity, 50);
  const bool is_between = across == aligned || across == fit;
  if (is_between) {
    const Point way{second.x - first.x, second.y - first.y, 0};
    degrees = std::atan2(way.y, way.x) / geometry::radians_per_degree;
    block.fit_width = norm(way) / height;
    block.fits_height = across == aligned;
  } else if (across != left || up != 0) {
    at = second;
    block.align = across == right ? 1 : across == left ? 0 : 0.5;
    block.anchor = across == middle ? TextAnchor::middle : anchor_of(up);
  }
  const int flags = dxf.integer(entity, 71);
  const double wide = is_between ? 1 : dxf.number(entity, 41, 1);
  const double oblique = std::clamp(dxf.number(entity, 51), -max_oblique_deg, max_oblique_deg);
  Affine letters = geometry::scaled((flags & backwards) != 0 ? -wide : wide,
                                    (flags & upside_down) != 0 ? -1 : 1, 1);
  letters.y.x = std::tan(oblique * geometry::radians_per_degree) * letters.y.y;
  block.frame = dxf_world(dxf, entity) * geometry::moved(at.x, at.y, at.z) *
                geometry::turned_about_z(degrees) * geometry::scaled(height, height, 1) * letters;
  return block;
}

TextBlock paragraph_text(const DxfGroups& dxf, const DxfEntity& entity) {
  // Distance between baselines of single spacing, in heights of the text ("DXF Reference", MTEXT).
  constexpr double single_spacing = 5.0 / 3;
  std::string value;
  for (const DxfGroup& group : entity.groups)
    if (group.code == 3) value += group.value;
  value += dxf.text(entity, 1);
  TextBlock block;
  block.lines = dxf_lines(value);
  const double height = height_of(dxf, entity);
  // 1 to 9: top, middle, bottom from the left to the right.
  const int place = std::clamp(dxf.integer(entity, 71, 1), 1, 9) - 1;
  block.align = place % 3 * 0.5;
  block.anchor = place < 3 ? TextAnchor::top : place < 6 ? TextAnchor::middle : TextAnchor::bottom;
  block.line_step = single_spacing * dxf.number(entity, 44, 1);
  block.wrap_width = std::max(0.0, dxf.number(entity, 41)) / height;
  // The direction of X or an angle, whichever is later in the file.
  Affine turn;
  for (const DxfGroup& group : entity.groups) {
    if (group.code == 50) turn = geometry::turned_about_z(dxf.number(group));
    if (group.code != 11) continue;
    const Point along = dxf.point(entity, 11);
    turn = geometry::turned_about_z(std::atan2(along.y, along.x) / geometry::radians_per_degree);
  }
  const Point at = dxf.point(entity, 10);
  block.frame = geometry::moved(at.x, at.y, at.z) * turn * geometry::scaled(height, height, 1);
  return block;
}

}  // namespace

std::string dxf_characters(std::string_view value) {
  const std::string bytes = in_utf8(value);
  std::string text;
  for (std::string_view rest = bytes; !rest.empty();) {
    std::size_t used = append_unicode(text, rest);
    if (used == 0) used = append_percent_code(text, rest);
    if (used == 0) {
      text += rest.front();
      used = 1;
    }
    rest.remove_prefix(used);
  }
  return text;
}

std::vector<std::string> dxf_lines(std::string_view value) {
  const std::string bytes = in_utf8(value);
  return PlainLines(bytes).lines();
}

std::optional<TextBlock> dxf_text(const DxfGroups& dxf, const DxfEntity& entity) {
  constexpr int invisible = 1;
  if (entity.kind == "ATTRIB" && (dxf.integer(entity, 70) & invisible) != 0) return std::nullopt;
  std::optional<TextBlock> block;
  if (entity.kind == "TEXT" || entity.kind == "ATTRIB") block = line_text(dxf, entity);
  if (entity.kind == "MTEXT") block = paragraph_text(dxf, entity);
  if (!block || is_blank(block->lines)) return std::nullopt;
  return block;
}

}  // namespace lamplock::model
