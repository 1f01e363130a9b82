#include "host/model/svg_paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "host/letter_case.hpp"
#include "host/model/svg_colour.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// A number or a percentage, as the properties of opacity have it.
std::optional<double> part_of_one(std::string_view text) {
  const bool has_unit = !text.empty() && text.back() >= 'a' && text.back() <= 'z';
  return has_unit ? std::nullopt : find_svg_length(text, 1, {});
}

/// True if a paint leaves a mark. `url(#id)` needs its element, or a colour after it.
bool is_visible_paint(std::string_view text, const SvgDocument& document) {
  if (text.starts_with("url(")) {
    const std::size_t end = text.find(')');
    if (document.find_url(text)) return true;
    text = end == std::string_view::npos ? std::string_view{} : trimmed(text.substr(end + 1));
    if (text.empty()) return false;
  }
  const auto colour = find_svg_colour(text);
  return text != "none" && (!colour || colour->alpha > 0);
}

bool is_current_colour(std::string_view text) { return in_lower_case(text) == "currentcolor"; }

bool is_white(std::string_view text) {
  return find_svg_colour(text).value_or(SvgColour{}).is_white;
}

/// The lengths of stroke-dasharray, an even number; empty for "none" or if all are 0. No value for
/// an invalid list.
std::optional<std::vector<double>> dashes_of(std::string_view text, const SvgUnits& units) {
  std::vector<double> lengths;
  if (text == "none") return lengths;
  double sum = 0;
  constexpr std::string_view separators = " ,\t\r\n";
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view one = text.substr(0, text.find_first_of(separators));
    const auto length = find_svg_length(one, svg_diagonal(units.port), units);
    if (!length || !(*length >= 0)) return std::nullopt;
    lengths.push_back(*length);
    sum += *length;
    text.remove_prefix(one.size());
  }
  if (lengths.empty()) return std::nullopt;
  if (!(sum > 0) || !std::isfinite(sum)) return std::vector<double>{};
  if (lengths.size() % 2 != 0) {
    const std::vector<double> once = lengths;
    lengths.insert(lengths.end(), once.begin(), once.end());
  }
  return lengths;
}

template <std::size_t size>
bool is_keyword_of(const std::array<std::string_view, size>& keywords, std::string_view text) {
  return std::find(keywords.begin(), keywords.end(), text) != keywords.end();
}

void inherit_stroke(const xml_node& node, const SvgUnits& units, const SvgDocument& document,
                    SvgPaint& paint) {
  const auto value = [&](const char* name) { return svg_value(node, name); };
  const double diagonal = svg_diagonal(units.port);
  if (const auto stroke = value("stroke"); !stroke.empty()) {
    paint.has_stroke = is_visible_paint(stroke, document);
    paint.stroke_colour = colour_named(stroke).value_or(no_colour);
    paint.stroke_is_current = is_current_colour(stroke);
  }
  paint.stroke_opacity = part_of_one(value("stroke-opacity")).value_or(paint.stroke_opacity);
  paint.stroke_width =
      find_svg_length(value("stroke-width"), diagonal, units).value_or(paint.stroke_width);
  if (auto dashes = dashes_of(value("stroke-dasharray"), units)) paint.dashes = std::move(*dashes);
  paint.dash_offset =
      find_svg_length(value("stroke-dashoffset"), diagonal, units).value_or(paint.dash_offset);
  if (const auto ends = value("stroke-linecap"); !ends.empty())
    paint.has_long_ends = ends == "round" || ends == "square";
}

/// The colour of an element, of which a child's currentColor is, also where fill and stroke are
/// inherited (CSS Color Module Level 4, "The currentcolor keyword").
void inherit_colour(std::string_view colour, SvgPaint& paint) {
  if (!colour.empty() && !is_current_colour(colour)) {
    paint.current_colour = colour_named(colour).value_or(no_colour);
    paint.current_is_white = is_white(colour);
    paint.current_is_visible = find_svg_colour(colour).value_or(SvgColour{}).alpha > 0;
  }
  if (paint.stroke_is_current) {
    paint.has_stroke = paint.current_is_visible;
    paint.stroke_colour = paint.current_colour;
  }
  if (paint.fill_is_current) {
    paint.has_fill = paint.current_is_visible;
    paint.fill_is_white = paint.current_is_white;
    paint.fill_colour = paint.current_colour;
  }
}

}  // namespace

std::string_view svg_value(const xml_node& node, const char* name) {
  return trimmed(node.attribute(name).value());
}

void inherit_paint(const xml_node& node, const SvgUnits& units, const SvgDocument& document,
                   SvgPaint& paint) {
  const auto value = [&](const char* name) { return svg_value(node, name); };
  if (const auto visibility = value("visibility"); !visibility.empty())
    paint.is_visible = visibility != "hidden" && visibility != "collapse";
  if (const auto fill = value("fill"); !fill.empty()) {
    paint.has_fill = is_visible_paint(fill, document);
    paint.fill_is_white = is_white(fill);
    paint.fill_colour = colour_named(fill).value_or(no_colour);
    paint.fill_is_server = fill.starts_with("url(");
    paint.fill_is_current = is_current_colour(fill);
    paint.fill_is_default = false;
  }
  if (const auto rule = value("fill-rule"); !rule.empty())
    paint.fill_rule = rule == "evenodd" ? FillRule::even_odd : FillRule::non_zero;
  paint.fill_opacity = part_of_one(value("fill-opacity")).value_or(paint.fill_opacity);
  inherit_stroke(node, units, document, paint);
  inherit_colour(value("color"), paint);
}

bool is_valid_svg_value(std::string_view property, std::string_view text) {
  constexpr std::array<std::string_view, 5> of_all{"inherit", "initial", "unset", "revert",
                                                   "revert-layer"};
  const std::string value = in_lower_case(trimmed(text));
  if (is_keyword_of(of_all, value)) return true;
  if (property == "fill" || property == "stroke") return is_svg_paint(value);
  if (property == "color") return find_svg_colour(value).has_value();
  if (property == "stroke-width") return find_svg_length(value, 1, {}).value_or(-1) >= 0;
  if (property == "stroke-dashoffset") return find_svg_length(value, 1, {}).has_value();
  if (property == "stroke-dasharray") return dashes_of(value, {}).has_value();
  if (property == "opacity" || property.ends_with("-opacity"))
    return part_of_one(value).has_value();
  if (property == "visibility")
    return is_keyword_of(std::array<std::string_view, 3>{"visible", "hidden", "collapse"}, value);
  if (property == "stroke-linecap")
    return is_keyword_of(std::array<std::string_view, 3>{"butt", "round", "square"}, value);
  if (property == "fill-rule" || property == "clip-rule")
    return is_keyword_of(std::array<std::string_view, 2>{"nonzero", "evenodd"}, value);
  return true;
}

bool has_dashes(const xml_node& shape, const SvgPaint& paint) {
  const bool shows_edge = paint.shows_fill() && !paint.fill_is_default && !paint.fill_is_white &&
                          std::string_view(shape.name()) != "line";
  return !paint.dashes.empty() && paint.shows_stroke() && !shows_edge;
}

bool shows_filled_edge(const xml_node& shape, const SvgPaint& paint) {
  const bool is_on_white = paint.fill_is_white && paint.shows_stroke();
  return paint.shows_fill() && !is_on_white && !has_dashes(shape, paint);
}

bool is_not_rendered(const xml_node& node) {
  return svg_value(node, "display") == "none" ||
         part_of_one(svg_value(node, "opacity")).value_or(1) <= 0;
}

}  // namespace lamplock::model
