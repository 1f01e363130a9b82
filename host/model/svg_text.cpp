#include "host/model/svg_text.hpp"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <optional>
#include <string_view>
#include <utility>

#include "host/model/svg_elements.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/model/svg_style.hpp"
#include "host/model/utf8.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// What the characters of an element have in common.
struct Style {
  SvgUnits units;
  SvgPaint paint;
  bool keeps_blanks = false;
  double letter_spacing_px = 0, word_spacing_px = 0;
  double align = 0;
  TextAnchor anchor = TextAnchor::baseline;
};

/// What changes the letters of a text or their places, and is not read.
struct Unread {
  const char* name;
  std::string_view initial;
};
constexpr std::array<Unread, 4> unread_properties{{{"textLength", "none"},
                                                   {"text-transform", "none"},
                                                   {"text-decoration", "none"},
                                                   {"writing-mode", "horizontal"}}};

/// A property that the element or one of those around it sets.
std::string_view inherited(xml_node node, const char* name) {
  for (; node; node = node.parent())
    if (const auto value = svg_value(node, name); !value.empty()) return value;
  return {};
}

double align_of(std::string_view anchor) {
  return anchor == "middle" ? 0.5 : anchor == "end" ? 1 : 0;
}

TextAnchor anchor_of(std::string_view baseline) {
  if (baseline == "middle" || baseline == "central") return TextAnchor::middle;
  if (baseline == "hanging" || baseline == "text-before-edge" || baseline == "text-top")
    return TextAnchor::top;
  if (baseline == "text-after-edge" || baseline == "text-bottom" || baseline == "ideographic")
    return TextAnchor::bottom;
  return TextAnchor::baseline;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

class TextWalk {
 public:
  explicit TextWalk(const SvgDocument& document) : document_(document) {}

  SvgText text(const xml_node& node, Style style) {
    enter(node, style);
    walk(node, style);
    if (!style.keeps_blanks && is_after_blank_ && !result_.runs.empty())
      result_.runs.back().lines[0].pop_back();
    std::erase_if(result_.runs, [](const TextBlock& run) { return run.lines[0].empty(); });
    return std::move(result_);
  }

 private:
  /// Reads what the element itself sets: where its first characters are, how blanks are read.
  void enter(const xml_node& node, Style& style) {
    const auto take = [&](const char* name, double whole, std::deque<double>& places) {
      const std::string_view value = svg_value(node, name);
      if (value.empty()) return;
      places.clear();
      constexpr std::string_view separators = " ,\t\r\n";
      for (std::size_t at = value.find_first_not_of(separators); at < value.size();
           at = value.find_first_not_of(separators, at)) {
        const std::string_view one = value.substr(at, value.find_first_of(separators, at) - at);
        places.push_back(svg_length(one, whole, style.units, document_.position_of(node)));
        at += one.size();
      }
    };
    take("x", style.units.port.width, x_);
    take("y", style.units.port.height, y_);
    take("dx", style.units.port.width, dx_);
    take("dy", style.units.port.height, dy_);
    if (const auto space = svg_value(node, "xml:space"); !space.empty())
      style.keeps_blanks = space == "preserve";
    style.align = align_of(inherited(node, "text-anchor"));
    style.anchor = anchor_of(inherited(node, "dominant-baseline"));
    style.letter_spacing_px = spacing(node, "letter-spacing", style.units);
    style.word_spacing_px = spacing(node, "word-spacing", style.units);
    const bool is_whole = svg_name(node) == "text";
    for (const Unread& unread : unread_properties) {
      const auto value = is_whole ? inherited(node, unread.name) : svg_value(node, unread.name);
      if (!value.empty() && !value.starts_with(unread.initial))
        result_.left_out.emplace_back(fmt::format("{} of a text", unread.name));
    }
  }

  static double spacing(const xml_node& node, const char* name, const SvgUnits& units) {
    return find_svg_length(inherited(node, name), units.font_px, units).value_or(0);
  }

  void walk(const xml_node& node, const Style& style) {
    for (const xml_node& child : node.children()) {
      if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
        append(child.value(), style);
      } else if (child.type() == pugi::node_element) {
        walk_element(child, style);
      }
    }
  }

  void walk_element(const xml_node& node, Style style) {
    const std::string_view name = svg_name(node);
    if (name != "tspan" && name != "a") {
      if (!svg_draws_nothing(name)) result_.left_out.emplace_back(name);
      return;
    }
    if (is_not_rendered(node)) return;
    style.units.font_px = svg_font_size(svg_value(node, "font-size"), style.units);
    inherit_paint(node, style.units, document_, style.paint);
    enter(node, style);
    is_same_style_ = false;
    walk(node, style);
    for (std::deque<double>* places : {&x_, &y_, &dx_, &dy_}) places->clear();
    is_same_style_ = false;
  }

  void append(std::string_view text, const Style& style) {
    while (!text.empty()) {
      std::size_t length = 1;
      while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U)
        ++length;
      const std::string_view character = text.substr(0, length);
      text.remove_prefix(length);
      const bool blank = is_blank(character[0]);
      if (blank && !style.keeps_blanks && is_after_blank_) continue;
      is_after_blank_ = blank;
      append_character(blank ? " " : character, style);
    }
  }

  static std::optional<double> taken(std::deque<double>& places) {
    if (places.empty()) return std::nullopt;
    const double first = places.front();
    places.pop_front();
    return first;
  }

  /// A run begins where the character has a place of its own, or another style.
  void append_character(std::string_view character, const Style& style) {
    const std::optional<double> x = taken(x_), y = taken(y_);
    const double spacing = x ? 0 : spacing_px_;
    const double dx = taken(dx_).value_or(0) + spacing, dy = taken(dy_).value_or(0);
    spacing_px_ = style.letter_spacing_px + (character == " " ? style.word_spacing_px : 0);
    if (y) at_y_ = *y;
    at_y_ += dy;
    const bool begins = result_.runs.empty() || x || y || dx != 0 || dy != 0 || !is_same_style_;
    if (begins) begin_run(x, dx, style);
    is_same_style_ = true;
    result_.runs.back().lines[0] += character;
  }

  void begin_run(std::optional<double> x, double dx, const Style& style) {
    TextBlock run;
    run.lines.resize(1);
    run.unit = TextUnit::em;
    run.size = style.units.font_px;
    run.anchor = style.anchor;
    run.is_drawn = style.paint.shows_fill() || style.paint.shows_stroke();
    run.is_filled = style.paint.shows_fill();
    run.covers = style.paint.fill_is_white;
    run.colour = style.paint.colour();
    run.follows = !x && !result_.runs.empty();
    if (run.follows) {
      run.frame = result_.runs.back().frame;
      run.align = result_.runs.back().align;
      run.shift_x = dx;
      run.shift_y = begin_y_ - at_y_;  // y is downwards
    } else {
      begin_y_ = at_y_;
      run.align = style.align;
      run.frame = geometry::moved(x.value_or(0) + dx, at_y_, 0) * geometry::scaled(1, -1, 1);
    }
    result_.runs.push_back(std::move(run));
  }

  const SvgDocument& document_;
  SvgText result_;
  std::deque<double> x_, y_, dx_, dy_;  ///< of the characters to come
  double at_y_ = 0, begin_y_ = 0;       ///< of the character, of the first run of its line
  double spacing_px_ = 0;               ///< after the last character
  bool is_after_blank_ = true, is_same_style_ = true;
};

}  // namespace

SvgText svg_text(const xml_node& text, const SvgUnits& units, const SvgPaint& paint,
                 const SvgDocument& document) {
  return TextWalk(document).text(text, {units, paint});
}

}  // namespace lamplock::model
