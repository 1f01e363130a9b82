#include "host/cutting/post_template.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "host/gcode_comments.hpp"
#include "host/letter_case.hpp"

namespace lamplock::cutting {
namespace {

std::optional<std::size_t> value_named(std::string_view name) {
  const auto found = std::find(post_value_names.begin(), post_value_names.end(), name);
  if (found == post_value_names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - post_value_names.begin());
}

/// A bit for each value whose word is followed by a number outside of comments: S0, F600, Z-5.
std::uint32_t fixed_values(std::string_view line) {
  struct Word {
    char letter;
    PostValue value;
  };
  constexpr std::array<Word, 5> words{{{'X', PostValue::x},
                                       {'Y', PostValue::y},
                                       {'Z', PostValue::z},
                                       {'F', PostValue::feed},
                                       {'S', PostValue::power}}};
  const std::string text = in_upper_case(without_comments(line));
  std::uint32_t fixed = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const Word& word : words) {
      if (text[i] != word.letter) continue;
      const std::size_t next = text.find_first_not_of(' ', i + 1);
      constexpr std::string_view numbers = "0123456789.+-";
      if (next != std::string::npos && numbers.find(text[next]) != std::string_view::npos)
        fixed |= std::uint32_t{1} << static_cast<std::size_t>(word.value);
    }
  }
  return fixed;
}

/// 10 to a power that is not negative.
double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

/// A number with all its decimals. Whole numbers are written many times faster than others; those
/// up to 2^53 are exact.
std::string decimal_text(double value, int decimals) {
  constexpr double max_whole = 9007199254740992.0;
  const double scaled = std::round(value * power_of_ten(decimals));
  if (!(std::abs(scaled) < max_whole)) return fmt::format("{:.{}f}", value, decimals);
  const fmt::format_int digits(static_cast<std::uint64_t>(std::abs(scaled)));
  const auto places = static_cast<std::size_t>(decimals);
  const std::size_t whole = digits.size() > places ? digits.size() - places : 0;
  std::string text(scaled < 0 ? "-" : "");
  if (whole > 0)
    text.append(digits.data(), whole);
  else
    text += '0';
  if (places == 0) return text;
  text += '.';
  if (whole == 0) text.append(places - digits.size(), '0');
  return text.append(digits.data() + whole, digits.size() - whole);
}

}  // namespace

std::string post_number(double value, int decimals) {
  std::string text = decimal_text(value, decimals);
  if (decimals == 0) return text;
  const auto last = text.find_last_not_of('0');
  text.resize(text[last] == '.' ? last : last + 1);
  return text;
}

PostTemplates::PostTemplates(const Post& post) {
  for (std::size_t i = 0; i < lines_.size(); ++i)
    for (const std::string& line : post.lines[i]) lines_[i].push_back(template_of(line));
}

PostTemplates::Template PostTemplates::template_of(const std::string& text) {
  Template whole;
  whole.fixed = fixed_values(text);
  std::vector<Piece>& pieces = whole.pieces;
  const auto text_at_end = [&]() -> std::string& {
    if (pieces.empty() || pieces.back().kind != PieceKind::text)
      pieces.push_back({PieceKind::text});
    return pieces.back().text;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '{') {
      const std::size_t close = text.find('}', i);
      const std::size_t value = *value_named(text.substr(i + 1, close - i - 1));
      pieces.push_back({PieceKind::value, {}, value});
      used_ |= bit(value);
      i = close;
    } else if (c == '[') {
      pieces.push_back({PieceKind::part_begin});
    } else if (c == ']') {
      pieces.push_back({PieceKind::part_end});
    } else {
      text_at_end() += c;
    }
  }
  return whole;
}

std::size_t PostTemplates::append(PostEvent event, std::string& program) {
  std::size_t count = 0;
  for (const Template& line : lines_[static_cast<std::size_t>(event)]) {
    const std::size_t begin = program.size();
    fill(line, program);
    if (program.size() == begin) continue;
    program += '\n';
    ++count;
  }
  return count;
}

void PostTemplates::fill(const Template& line, std::string& program) {
  std::uint32_t in_line = 0, in_part = 0;  // values
  std::size_t part_begin = 0;
  bool is_part = false, has_changed = false;
  for (const Piece& piece : line.pieces) {
    switch (piece.kind) {
      case PieceKind::text:
        program += piece.text;
        break;
      case PieceKind::value:
        program += values_[piece.value];
        (is_part ? in_part : in_line) |= bit(piece.value);
        has_changed = has_changed || values_[piece.value] != written_[piece.value];
        break;
      case PieceKind::part_begin:
        is_part = true;
        has_changed = false;
        in_part = 0;
        part_begin = program.size();
        break;
      case PieceKind::part_end:
        is_part = false;
        if (has_changed)
          in_line |= in_part;
        else
          program.resize(part_begin);
        break;
    }
  }
  for (std::size_t i = 0; in_line != 0; ++i, in_line >>= 1)
    if ((in_line & 1u) != 0) written_[i] = values_[i];
  std::uint32_t fixed = line.fixed;
  for (std::size_t i = 0; fixed != 0; ++i, fixed >>= 1)
    if ((fixed & 1u) != 0) written_[i].clear();
}

std::string template_fault(const std::string& text) {
  bool in_part = false, has_value = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '{') {
      const std::size_t close = text.find('}', i);
      if (close == std::string::npos) return "a brace is not closed";
      const std::string name = text.substr(i + 1, close - i - 1);
      if (!value_named(name))
        return fmt::format("there is no value '{}', but {}", name,
                           fmt::join(post_value_names, ", "));
      has_value = true;
      i = close;
    } else if (c == '}') {
      return "a brace is closed that is not open";
    } else if (c == '[') {
      if (in_part) return "square brackets are inside each other";
      in_part = true;
      has_value = false;
    } else if (c == ']') {
      if (!in_part) return "a square bracket is closed that is not open";
      if (!has_value) return "a part in square brackets has no value in braces";
      in_part = false;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      return "a line has a line end or a control character in it";
    }
  }
  return in_part ? "a square bracket is not closed" : "";
}

}  // namespace lamplock::cutting
